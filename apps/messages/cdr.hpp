#pragma once

#ifdef SPLINECAST_HAS_FASTCDR

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace splinecast::apps {

/// Reads the values of a CDR message in their order. Throws MessageError with the byte offset for a
/// value that goes beyond the end of the message.
class CdrReader {
 public:
  /// Reads the encapsulation header. Throws MessageError for another encoding than plain CDR.
  explicit CdrReader(std::span<const std::byte> message);
  CdrReader(const CdrReader&) = delete;
  CdrReader& operator=(const CdrReader&) = delete;
  ~CdrReader() = default;

  [[nodiscard]] std::int32_t int32();
  [[nodiscard]] std::uint32_t uint32();
  void doubles(std::span<double> values);
  /// A view into the message, without the terminating 0.
  [[nodiscard]] std::string_view string();
  /// The length of a sequence whose elements have at least this size. Throws if they cannot fit
  /// into the rest of the message.
  [[nodiscard]] std::size_t length(std::size_t element_bytes);
  /// A sequence of doubles.
  void doubles(std::vector<double>& values);

  [[nodiscard]] std::size_t offset() const { return cdr_.getSerializedDataLength(); }
  [[noreturn]] void fail(const char* what, std::size_t value) const;

 private:
  [[nodiscard]] std::size_t left() const { return size_ - offset(); }

  std::size_t size_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_;
};

}  // namespace splinecast::apps

#endif
