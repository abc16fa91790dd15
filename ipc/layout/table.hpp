#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "ipc/memory/word.hpp"

/// The description of a part of a region: a table of fields, each with its name, place, size,
/// writer and meaning. The same rows define the offsets that the code uses, the copies to and from
/// the members of a struct, the layout hash, and the page that describes the bytes.
namespace splinecast::ipc {

/// The process that stores a field.
enum class FieldWriter : std::uint8_t {
  maker,  ///< the process that creates the region, before it gets its name
  owner,  ///< the process that owns the region: the producer or the solver
  padding,
};

/// A number of words that depends on the number of dimensions D: words + per_dimension·D.
struct Extent {
  std::size_t words = 0;
  std::size_t per_dimension = 0;

  [[nodiscard]] constexpr std::size_t of(std::size_t dimensions) const noexcept {
    return words + per_dimension * dimensions;
  }
  friend constexpr Extent operator+(Extent a, Extent b) noexcept {
    return {a.words + b.words, a.per_dimension + b.per_dimension};
  }
  friend constexpr bool operator==(const Extent&, const Extent&) = default;
};

/// One row of a part's table. Its offset, from the beginning of the part, is the sum of the sizes
/// of the rows before it.
struct Field {
  std::string_view name;
  Extent offset;
  Extent size;
  FieldWriter writer{};
  std::string_view meaning;  ///< text for the page; may have several lines
};

/// A field whose offset has not been computed yet: the input of place().
struct FieldRow {
  std::string_view name;
  Extent size;
  FieldWriter writer{};
  std::string_view meaning;
};

/// A row for a member of a struct. Its size is the member's: one word for a bool.
template <auto Member>
struct MemberRow {
  std::string_view name;
  FieldWriter writer{};
  std::string_view meaning;
};

/// Unused words.
[[nodiscard]] constexpr FieldRow padding(std::size_t words) noexcept {
  return {.name = "", .size = {.words = words}, .writer = FieldWriter::padding, .meaning = ""};
}

namespace detail {

template <auto Member>
struct MemberOf;
template <typename Struct, typename Value, Value Struct::*Member>
struct MemberOf<Member> {
  using type = Value;
  static_assert(std::is_trivially_copyable_v<Value>);
  static constexpr bool is_flag = std::is_same_v<Value, bool>;
  static_assert(is_flag || sizeof(Value) % sizeof(Word) == 0);
  static constexpr std::size_t bytes = sizeof(Value);
  static constexpr std::size_t words = is_flag ? 1 : bytes / sizeof(Word);
};

constexpr FieldRow as_row(const FieldRow& row) noexcept { return row; }
template <auto Member>
constexpr FieldRow as_row(const MemberRow<Member>& row) noexcept {
  return {row.name, {.words = MemberOf<Member>::words}, row.writer, row.meaning};
}

}  // namespace detail

/// Places rows contiguously.
template <typename... Rows>
[[nodiscard]] constexpr std::array<Field, sizeof...(Rows)> place(
    const std::tuple<Rows...>& rows) noexcept {
  return std::apply(
      [](const auto&... row) {
        std::array<Field, sizeof...(Rows)> fields{};
        Extent offset;
        std::size_t i = 0;
        const auto add = [&](const FieldRow& each) {
          fields[i++] = {each.name, offset, each.size, each.writer, each.meaning};
          offset = offset + each.size;
        };
        (add(detail::as_row(row)), ...);
        return fields;
      },
      rows);
}

/// The field of that name. An unknown name is a compile-time error.
[[nodiscard]] consteval Field field_of(std::span<const Field> fields, std::string_view name) {
  for (const Field& field : fields) {
    if (field.name == name) return field;
  }
  throw "no field has this name";
}

/// The offset of a field, in words. An offset that depends on D is a compile-time error.
[[nodiscard]] consteval std::size_t word_of(std::span<const Field> fields, std::string_view name) {
  const Extent offset = field_of(fields, name).offset;
  if (offset.per_dimension != 0) throw "this offset depends on the number of dimensions";
  return offset.words;
}

/// The number of words of all fields.
[[nodiscard]] constexpr Extent size_of(std::span<const Field> fields) noexcept {
  return fields.empty() ? Extent{} : fields.back().offset + fields.back().size;
}

namespace detail {

template <auto Member, typename Struct>
void encode_row(const MemberRow<Member>& /*row*/, const Struct& from, Word*& to) noexcept {
  using Of = MemberOf<Member>;
  if constexpr (Of::is_flag) {
    *to = from.*Member ? 1 : 0;
  } else {
    std::memcpy(to, &(from.*Member), sizeof(from.*Member));
  }
  to += Of::words;
}
template <typename Struct>
void encode_row(const FieldRow& row, const Struct& /*from*/, Word*& to) noexcept {
  to += row.size.words;
}

/// If `word` differs from `held[index]`, stores it there and calls `changed(index, word)`.
inline void take_word(Word word, std::size_t index, Word* held, const auto& changed) noexcept {
  if (word == held[index]) return;
  held[index] = word;
  changed(index, word);
}

template <auto Member, typename Struct>
[[gnu::always_inline]] inline void encode_changed_row(const MemberRow<Member>& /*row*/,
                                                      const Struct& from, Word* held,
                                                      std::size_t& at,
                                                      const auto& changed) noexcept {
  using Of = MemberOf<Member>;
  if constexpr (Of::is_flag) {
    take_word(from.*Member ? 1 : 0, at, held, changed);
  } else {
    std::array<Word, Of::words> words{};
    std::memcpy(words.data(), &(from.*Member), sizeof(from.*Member));
    for (std::size_t i = 0; i < words.size(); ++i) take_word(words[i], at + i, held, changed);
  }
  at += Of::words;
}
template <typename Struct>
void encode_changed_row(const FieldRow& row, const Struct& /*from*/, Word* /*held*/,
                        std::size_t& at, const auto& /*changed*/) noexcept {
  at += row.size.words;
}

template <auto Member, typename Struct>
void decode_row(const MemberRow<Member>& /*row*/, const Word*& from, Struct& to) noexcept {
  using Of = MemberOf<Member>;
  if constexpr (Of::is_flag) {
    to.*Member = *from != 0;
  } else {
    std::memcpy(static_cast<void*>(&(to.*Member)), from, sizeof(to.*Member));
  }
  from += Of::words;
}
template <typename Struct>
void decode_row(const FieldRow& row, const Word*& from, Struct& /*to*/) noexcept {
  from += row.size.words;
}

}  // namespace detail

/// Copies members to the words of their rows. Words without a member do not change.
template <typename Rows, typename Struct>
void encode(const Rows& rows, const Struct& from, Word* to) noexcept {
  std::apply([&](const auto&... row) { (detail::encode_row(row, from, to), ...); }, rows);
}
/// Like encode, but updates only those words of `held` that differ, and calls `changed(index,
/// word)` for each of them.
template <typename Rows, typename Struct>
void encode_changes(const Rows& rows, const Struct& from, Word* held,
                    const auto& changed) noexcept {
  std::size_t at = 0;
  std::apply(
      [&](const auto&... row) { (detail::encode_changed_row(row, from, held, at, changed), ...); },
      rows);
}
/// Copies the words of rows to their members.
template <typename Rows, typename Struct>
void decode(const Rows& rows, const Word* from, Struct& to) noexcept {
  std::apply([&](const auto&... row) { (detail::decode_row(row, from, to), ...); }, rows);
}

/// A part of the two regions: its fields, and the description of where it begins.
struct LayoutPart {
  std::string_view name;
  std::string_view place;  ///< where it begins: text for the page
  std::span<const Field> fields;
};

/// Every part, in the order of the page.
[[nodiscard]] std::span<const LayoutPart> layout_parts() noexcept;

/// A hash that identifies a layout: FNV-1a over the name of each part and the name, offset, size
/// and writer of each field. The overload without parameters hashes the layout of this build.
[[nodiscard]] std::uint64_t layout_hash(std::span<const LayoutPart> parts) noexcept;
[[nodiscard]] std::uint64_t layout_hash() noexcept;

/// The page that describes the bytes, as Markdown.
[[nodiscard]] std::string layout_page();

}  // namespace splinecast::ipc
