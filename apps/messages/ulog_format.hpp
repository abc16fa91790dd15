#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace splinecast::apps::ulog {

enum class FieldType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  boolean,
  character
};

/// A number in a sample: `x`, `q[0]`, `esc[1].rpm`.
struct Field {
  std::string path;
  FieldType type{};
  std::size_t offset = 0;  ///< in the sample, in bytes
};

/// The value of a field. Integers beyond 2^53 are rounded.
[[nodiscard]] double value_of(const Field& field, std::span<const std::byte> sample);

/// The formats that a log defines. They may contain each other.
class Formats {
 public:
  /// Adds a definition: `name:type field;type[length] field;`. Throws MessageError if it is not
  /// one.
  void add(std::string_view definition);

  /// All numbers in a sample of a format, without padding. Throws MessageError for an unknown
  /// format, for formats nested more than 16 levels deep, for more than 65535 bytes, and if the
  /// calls so far found more than 2^20 fields.
  [[nodiscard]] std::vector<Field> fields(std::string_view format);

  /// The number of bytes of a sample, without the padding at its end.
  [[nodiscard]] static std::size_t size(const std::vector<Field>& fields);

 private:
  struct Member {
    std::string type;
    std::string name;
    std::size_t length = 0;  ///< of an array; 0: no array
  };
  struct Layout;

  void arrange(std::string_view format, const std::string& prefix, Layout& layout);

  std::map<std::string, std::vector<Member>, std::less<>> formats_{};
  std::size_t found_ = 0;  ///< fields of all calls, those without bytes included
};

}  // namespace splinecast::apps::ulog
