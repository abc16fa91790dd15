#pragma once

#include <cstdint>

/// The numbers that identify a stream's region and its layout. The tables of this folder define the
/// place of every word of the two regions; docs/layout-fields.md is generated from them. A release
/// that changes a row adds 1 to kLayoutVersion. Between releases the layout hash distinguishes
/// layouts.
namespace splinecast::ipc {

inline constexpr std::uint64_t kMagic = 0x54534143'4e4c5053;  // "SPLNCAST" in memory order
inline constexpr std::uint32_t kLayoutVersion = 6;
inline constexpr std::uint32_t kByteOrder = 0x01020304;

/// The two numbers of the header's second word. All layout versions have them at this place, so
/// that each version recognises a region of another version.
struct LayoutMark {
  std::uint32_t version = kLayoutVersion;
  std::uint32_t byte_order = kByteOrder;
};

}  // namespace splinecast::ipc
