#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "ipc/arguments/arrays.hpp"

/// Structs that may grow. A program may have been compiled with another version of the header: its
/// struct is shorter or longer than this library's. `first` is the size of the struct in the first
/// version that had it, in bytes.
namespace splinecast::ipc {

/// Requires a `size` of `first` or more, and that no byte after `known` is set.
template <typename Struct>
void require_size(const Struct* given, std::size_t first, std::string_view name) {
  require_pointer(given, name);
  const std::size_t size = given->size;
  const std::string member = std::string(name) + "->size";
  if (size < first || size % alignof(Struct) != 0 || size > kMaxText) {
    refuse(member, "is " + std::to_string(size) + ", not " + std::to_string(sizeof(Struct)));
  }
  if (size <= sizeof(Struct)) return;
  const std::span bytes(reinterpret_cast<const std::byte*>(given), size);
  const auto unknown = bytes.subspan(sizeof(Struct));
  if (std::ranges::any_of(unknown, [](std::byte byte) { return byte != std::byte{}; })) {
    refuse(member, "is " + std::to_string(size) + ", and bytes after the " +
                       std::to_string(sizeof(Struct)) + " that this version knows are not 0");
  }
}

/// What a program has given, and the defaults of what its version of the struct lacks.
template <typename Struct>
[[nodiscard]] Struct read_struct(const Struct* given, const Struct& defaults, std::string_view name,
                                 std::size_t first = sizeof(Struct)) {
  require_size(given, first, name);
  Struct all = defaults;
  std::memcpy(static_cast<void*>(&all), given, std::min(given->size, sizeof(Struct)));
  all.size = sizeof(Struct);
  return all;
}

/// The same; null: the defaults.
template <typename Struct>
[[nodiscard]] Struct read_optional(const Struct* given, const Struct& defaults,
                                   std::string_view name, std::size_t first = sizeof(Struct)) {
  return given == nullptr ? defaults : read_struct(given, defaults, name, first);
}

/// Writes the members that the program's version of the struct has; `size` stays as it is.
template <typename Struct>
void write_struct(Struct filled, Struct* out) {
  filled.size = out->size;
  std::memcpy(static_cast<void*>(out), &filled, std::min(out->size, sizeof(Struct)));
}

}  // namespace splinecast::ipc
