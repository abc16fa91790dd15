#include "ipc/arguments/guard.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <new>

#include "splinecast.h"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::size_t kMessageBytes = 512;

/// An array, not a string: a thread that has recorded no memory is left must not need any.
thread_local std::array<char, kMessageBytes> last_error{};

/// Keeps a message. A cut one ends at the end of a UTF-8 character.
int record(int error, const char* message) noexcept {
  std::size_t length = strnlen(message, kMessageBytes);
  if (length == kMessageBytes) {
    --length;
    while (length > 0 && (static_cast<unsigned char>(message[length]) & 0xC0U) == 0x80U) --length;
  }
  std::copy_n(message, length, last_error.begin());
  last_error[length] = '\0';
  return error;
}

}  // namespace

const char* last_failure() noexcept { return last_error.data(); }

int record_failure() noexcept {
  try {
    throw;
  } catch (const BadRequest& error) {
    return record(SPLINECAST_ERROR_ARGUMENT, error.what());
  } catch (const std::invalid_argument& error) {
    return record(SPLINECAST_ERROR_ARGUMENT, error.what());
  } catch (const NoSuchStream& error) {
    return record(SPLINECAST_ERROR_NO_STREAM, error.what());
  } catch (const StreamBusy& error) {
    return record(SPLINECAST_ERROR_BUSY, error.what());
  } catch (const OutOfResources& error) {
    return record(SPLINECAST_ERROR_RESOURCES, error.what());
  } catch (const StreamError& error) {
    return record(SPLINECAST_ERROR_REGION, error.what());
  } catch (const std::bad_alloc&) {
    return record(SPLINECAST_ERROR_RESOURCES, "no memory is left");
  } catch (const std::exception& error) {
    return record(SPLINECAST_ERROR_INTERNAL, error.what());
  } catch (...) {
    return record(SPLINECAST_ERROR_INTERNAL, "an exception of unknown type");
  }
}

}  // namespace splinecast::ipc
