#pragma once

#include <cerrno>
#include <string>
#include <system_error>

#include "splinecast/errors.hpp"

namespace splinecast::ipc {

/// Whether errno value `error` means a shortage of resources: a retry may succeed when other
/// processes have freed some.
inline bool is_shortage(int error) noexcept {
  return error == ENOMEM || error == ENOSPC || error == EMFILE || error == ENFILE ||
         error == EDQUOT;
}

/// Throws OutOfResources or BadRegion: "`what`: text of the error".
[[noreturn]] inline void throw_failure(const std::string& what, int error) {
  const std::string text = what + ": " + std::generic_category().message(error);
  if (is_shortage(error)) throw OutOfResources(text);
  throw BadRegion(text);
}

}  // namespace splinecast::ipc
