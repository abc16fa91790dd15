#include "apps/messages/ulog_format.hpp"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <optional>

#include "apps/files/numbers.hpp"
#include "apps/messages/message_error.hpp"

namespace splinecast::apps::ulog {
namespace {

struct NumberType {
  std::string_view name;
  FieldType type;
  std::size_t bytes;
};

constexpr std::array<NumberType, 12> kTypes{{{"int8_t", FieldType::int8, 1},
                                             {"uint8_t", FieldType::uint8, 1},
                                             {"int16_t", FieldType::int16, 2},
                                             {"uint16_t", FieldType::uint16, 2},
                                             {"int32_t", FieldType::int32, 4},
                                             {"uint32_t", FieldType::uint32, 4},
                                             {"int64_t", FieldType::int64, 8},
                                             {"uint64_t", FieldType::uint64, 8},
                                             {"float", FieldType::float32, 4},
                                             {"double", FieldType::float64, 8},
                                             {"bool", FieldType::boolean, 1},
                                             {"char", FieldType::character, 1}}};

constexpr std::size_t kMostBytes = 65535;  ///< of a message: its size has 16 bits
constexpr std::size_t kMostLevels = 16;
constexpr std::size_t kMostFields = std::size_t{1} << 20U;  ///< of all formats
constexpr std::string_view kPadding = "_padding";

const NumberType* number_type(std::string_view name) {
  for (const NumberType& type : kTypes) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

template <typename T>
double number_at(std::span<const std::byte> sample, std::size_t offset) {
  T value{};
  std::memcpy(&value, sample.subspan(offset, sizeof value).data(), sizeof value);
  return static_cast<double>(value);
}

}  // namespace

/// The fields found so far.
struct Formats::Layout {
  std::vector<Field> fields{};
  std::size_t offset = 0;
  std::size_t levels = 0;
};

double value_of(const Field& field, std::span<const std::byte> sample) {
  switch (field.type) {
    case FieldType::int8:
      return number_at<std::int8_t>(sample, field.offset);
    case FieldType::uint8:
    case FieldType::boolean:
    case FieldType::character:
      return number_at<std::uint8_t>(sample, field.offset);
    case FieldType::int16:
      return number_at<std::int16_t>(sample, field.offset);
    case FieldType::uint16:
      return number_at<std::uint16_t>(sample, field.offset);
    case FieldType::int32:
      return number_at<std::int32_t>(sample, field.offset);
    case FieldType::uint32:
      return number_at<std::uint32_t>(sample, field.offset);
    case FieldType::int64:
      return number_at<std::int64_t>(sample, field.offset);
    case FieldType::uint64:
      return number_at<std::uint64_t>(sample, field.offset);
    case FieldType::float32:
      return number_at<float>(sample, field.offset);
    case FieldType::float64:
      return number_at<double>(sample, field.offset);
  }
  return 0;
}

void Formats::add(std::string_view definition) {
  const auto refuse = [&](std::string_view what) {
    throw MessageError(fmt::format("format '{}': '{}' is not a field", definition, what));
  };
  const std::size_t colon = definition.find(':');
  if (colon == std::string_view::npos || colon == 0) {
    throw MessageError(fmt::format("'{}' is not a format", definition));
  }
  std::vector<Member> members;
  std::string_view rest = definition.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view text = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(rest.size(), text.size() + 1));
    if (text.empty()) continue;
    const std::size_t blank = text.find(' ');
    if (blank == std::string_view::npos) refuse(text);
    Member member{.type = std::string(text.substr(0, blank)),
                  .name = std::string(text.substr(blank + 1))};
    if (const std::size_t open = member.type.find('['); open != std::string::npos) {
      if (!member.type.ends_with(']')) refuse(text);
      const auto length = parse_count(
          std::string_view(member.type).substr(open + 1, member.type.size() - open - 2));
      if (!length || *length == 0 || *length > kMostBytes) refuse(text);
      member.length = *length;
      member.type.resize(open);
    }
    members.push_back(std::move(member));
  }
  formats_.insert_or_assign(std::string(definition.substr(0, colon)), std::move(members));
}

std::vector<Field> Formats::fields(std::string_view format) {
  Layout layout;
  arrange(format, "", layout);
  return std::move(layout.fields);
}

void Formats::arrange(std::string_view format, const std::string& prefix, Layout& layout) {
  const auto found = formats_.find(format);
  if (found == formats_.end()) throw MessageError(fmt::format("unknown format '{}'", format));
  if (++layout.levels > kMostLevels) {
    throw MessageError(fmt::format("format '{}': nested more than 16 levels deep", format));
  }
  for (const Member& member : found->second) {
    const NumberType* type = number_type(member.type);
    const bool is_padding = member.name.starts_with(kPadding);
    for (std::size_t i = 0; i < std::max<std::size_t>(member.length, 1); ++i) {
      if (++found_ > kMostFields) throw MessageError("the formats have more than 2^20 fields");
      if (layout.offset > kMostBytes) {
        throw MessageError(fmt::format("format '{}': longer than 65535 bytes", format));
      }
      std::string path = prefix + member.name;
      if (member.length > 0) path += fmt::format("[{}]", i);
      if (type == nullptr) {
        arrange(member.type, path + ".", layout);
        continue;
      }
      if (!is_padding) {
        layout.fields.push_back(
            {.path = std::move(path), .type = type->type, .offset = layout.offset});
      }
      layout.offset += type->bytes;
    }
  }
  --layout.levels;
}

std::size_t Formats::size(const std::vector<Field>& fields) {
  if (fields.empty()) return 0;
  const Field& last = fields.back();
  for (const NumberType& type : kTypes) {
    if (type.type == last.type) return last.offset + type.bytes;
  }
  return last.offset;
}

}  // namespace splinecast::apps::ulog
