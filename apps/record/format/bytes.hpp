#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps::record {

static_assert(std::endian::native == std::endian::little);

using Bytes = std::vector<std::byte>;

/// Appends the fields of a message: integers and doubles in little-endian byte order, without
/// padding.
class ByteWriter {
 public:
  explicit ByteWriter(Bytes& out) noexcept : out_(out) {}

  template <typename T>
  requires std::integral<T> || std::floating_point<T> ByteWriter& put(T value) {
    return raw(std::as_bytes(std::span(&value, 1)));
  }
  ByteWriter& put(Time time) { return put(std::int64_t{time.count()}); }
  ByteWriter& put(std::span<const double> values) { return raw(std::as_bytes(values)); }
  ByteWriter& put(std::string_view text) { return raw(std::as_bytes(std::span(text))); }
  ByteWriter& raw(std::span<const std::byte> bytes) {
    const std::size_t at = out_.size();
    out_.resize(at + bytes.size());
    if (!bytes.empty()) std::memcpy(out_.data() + at, bytes.data(), bytes.size());
    return *this;
  }

 private:
  Bytes& out_;
};

/// A message that is not what a recorder writes. The text says what is wrong, without the file.
class BadMessage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Takes the fields of a message. Throws BadMessage if it is too short.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}

  template <typename T>
  [[nodiscard]] T take() {
    T value{};
    const auto bytes = take_bytes(sizeof value);
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  [[nodiscard]] Time take_time() { return Time(take<std::int64_t>()); }
  [[nodiscard]] std::vector<double> take_doubles(std::size_t count) {
    if (count > rest_.size() / sizeof(double)) throw BadMessage("it is too short");
    std::vector<double> values(count);
    const auto bytes = take_bytes(count * sizeof(double));
    if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  [[nodiscard]] std::span<const std::byte> take_bytes(std::size_t count) {
    if (count > rest_.size()) throw BadMessage("it is too short");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  [[nodiscard]] std::span<const std::byte> rest() const noexcept { return rest_; }
  void require_end() const {
    if (!rest_.empty()) throw BadMessage("it is too long");
  }

 private:
  std::span<const std::byte> rest_;
};

}  // namespace splinecast::apps::record
