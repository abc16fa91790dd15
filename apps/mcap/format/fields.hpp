#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "apps/mcap/format/record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::mcap {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

/// The number at `at`, which need not be aligned.
template <typename T>
[[nodiscard]] T load(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// A map of texts, such as the metadata of a channel.
using Pairs = std::map<std::string, std::string>;

/// The largest number of keys of such a map that a reader accepts.
inline constexpr std::size_t kMostPairs = 65536;

/// Reads the fields of a record, one after the other. Throws InputError with the byte offset if a
/// field goes beyond the record. Views are valid as long as the source.
class FieldReader {
 public:
  FieldReader(const Source& source, const Record& record) noexcept
      : source_(source), begin_(record.offset + kRecordHeader), content_(record.content) {}

  template <typename T>
  [[nodiscard]] T number() {
    return load<T>(take(sizeof(T)).data());
  }
  /// A time. Refuses those above Time::max().
  [[nodiscard]] Time time();
  [[nodiscard]] std::string_view string();
  /// Bytes whose number comes before them, as a number of type T.
  template <typename T>
  [[nodiscard]] std::span<const std::byte> bytes() {
    const auto size = number<T>();
    return take(size);
  }
  [[nodiscard]] Pairs pairs();
  [[nodiscard]] std::map<std::uint16_t, std::uint64_t> counts();
  [[nodiscard]] std::span<const std::byte> rest() noexcept { return content_.subspan(used_); }

 private:
  /// Reads the entries of a map: the bytes whose number comes before them.
  [[nodiscard]] FieldReader entries();
  [[nodiscard]] std::span<const std::byte> take(std::uint64_t size);

  Source source_;
  std::uint64_t begin_;  ///< offset of the content in the source
  std::span<const std::byte> content_;
  std::size_t used_ = 0;
};

}  // namespace splinecast::apps::mcap
