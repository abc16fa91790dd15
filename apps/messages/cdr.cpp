#include "apps/messages/cdr.hpp"

#ifdef SPLINECAST_HAS_FASTCDR

#include <fastcdr/exceptions/Exception.h>
#include <fmt/format.h>

#include "apps/messages/message_error.hpp"

namespace splinecast::apps {
namespace {

namespace cdr = eprosima::fastcdr;

constexpr std::size_t kHeaderBytes = 4;

/// FastBuffer has no constructor for memory that is only read.
char* bytes_of(std::span<const std::byte> message) {
  // NOLINTNEXTLINE(*-const-cast,*-reinterpret-cast): a Cdr that only deserializes writes nothing
  return const_cast<char*>(reinterpret_cast<const char*>(message.data()));
}

}  // namespace

CdrReader::CdrReader(std::span<const std::byte> message)
    : size_(message.size()),
      buffer_(bytes_of(message), message.size()),
      cdr_(buffer_, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR) {
  if (message.size() < kHeaderBytes) fail("the message ends in its encapsulation header", size_);
  const auto kind =
      std::to_integer<std::size_t>(message[0]) << 8U | std::to_integer<std::size_t>(message[1]);
  if (kind > 1) fail("the encapsulation is not that of plain CDR (0 or 1)", kind);
  cdr_.read_encapsulation();
}

void CdrReader::fail(const char* what, std::size_t value) const {
  throw MessageError(fmt::format("byte {}: {}: {}", offset(), what, value));
}

std::int32_t CdrReader::int32() { return static_cast<std::int32_t>(uint32()); }

std::uint32_t CdrReader::uint32() {
  std::uint32_t value = 0;
  try {
    cdr_.deserialize(value);
  } catch (const cdr::exception::Exception&) {
    fail("the message ends before a number of 4 bytes; bytes left", left());
  }
  return value;
}

void CdrReader::doubles(std::span<double> values) {
  try {
    cdr_.deserializeArray(values.data(), values.size());
  } catch (const cdr::exception::Exception&) {
    fail("the message ends before its numbers of 8 bytes; bytes left", left());
  }
}

std::string_view CdrReader::string() {
  const std::size_t length = uint32();
  if (length > left()) fail("a string is longer than the rest of the message; its length", length);
  if (length == 0) return {};
  const char* text = cdr_.getCurrentPosition();
  char last = 0;
  cdr_.jump(length - 1);
  cdr_.deserialize(last);  // not a jump: the next number is aligned
  return {text, last == '\0' ? length - 1 : length};
}

std::size_t CdrReader::length(std::size_t element_bytes) {
  const std::size_t length = uint32();
  if (length > left() / element_bytes) {
    fail("a sequence is longer than the rest of the message; its length", length);
  }
  return length;
}

void CdrReader::doubles(std::vector<double>& values) {
  values.resize(length(sizeof(double)));
  if (!values.empty()) doubles(std::span(values));
}

}  // namespace splinecast::apps

#endif
