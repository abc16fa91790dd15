#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "ipc/layout/mark.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

inline constexpr std::size_t kNameBytes = 32;
inline constexpr std::size_t kUnitBytes = 16;

/// The first words of both regions, as kHeaderRows places them.
struct RegionHeader {
  std::uint64_t magic = 0;
  LayoutMark mark;
  std::uint64_t layout_hash = 0;
  std::uint64_t kind = 0;            ///< RegionKind
  std::uint64_t region_bytes = 0;    ///< size of the whole region
  std::uint64_t stream_id = 0;       ///< random; the same in both regions of a stream
  std::uint64_t dimensions = 0;      ///< 1 … 64
  std::uint64_t capacity = 0;        ///< ring items or knot slots, a power of two
  std::uint64_t clock = 0;           ///< StreamClock
  std::uint64_t time_namespace = 0;  ///< inode of the time namespace of a live stream's clock
  std::uint64_t control = 0;         ///< offset of the control block, in bytes
  std::uint64_t stride = 0;          ///< bytes from one ring item or knot slot to the next
  std::int64_t min_interval = 0;     ///< ns between waypoints
  std::int64_t max_interval = 0;
  std::uint64_t start_kind = 0;  ///< ConditionKind at the first waypoint
  std::uint64_t method = 0;      ///< Method::number; 0: c2
  std::uint64_t settle = 0;      ///< settle lag K
  std::uint64_t tail = 0;        ///< Tail
  std::int64_t stop_time = 0;    ///< ns
  std::uint64_t epoch = 0;       ///< number of owners so far, from 1
  std::uint64_t owner_pid = 0;
  std::int64_t owner_since = 0;   ///< CLOCK_MONOTONIC when the owner took the region
  double lambda = 0;              ///< of smoothing, s³
  double time_scale = 0;          ///< of rounded, s
  std::uint64_t force_lag = 0;    ///< 1: a lag too short for lambda is accepted
  std::int64_t freeze_ahead = 0;  ///< ns that a live stream settles ahead of now
  std::int64_t history = 0;       ///< ns before now that a live stream keeps
  std::int64_t min_entry = 0;     ///< ns: least length of an entry
  std::array<double, kMaxDimensions> start_value{};
  std::array<std::uint64_t, kMaxDimensions> dimension_kind{};  ///< DimensionKind
  std::array<double, kMaxDimensions> period{};                 ///< of `periodic`; else 0
  std::array<std::array<char, kNameBytes>, kMaxDimensions> name{};
  std::array<std::array<char, kUnitBytes>, kMaxDimensions> unit{};
  std::array<double, kMaxDimensions> max_velocity{};  ///< 0: no limit, as in the next two
  std::array<double, kMaxDimensions> max_acceleration{};
  std::array<double, kMaxDimensions> max_jerk{};
  std::array<double, kMaxDimensions> lower_bound{};  ///< both bounds 0: none
  std::array<double, kMaxDimensions> upper_bound{};
  std::uint64_t beyond = 0;  ///< Beyond
};

inline constexpr std::tuple kHeaderRows{
    MemberRow<&RegionHeader::magic>{"magic", FieldWriter::maker, "the characters `SPLNCAST`"},
    MemberRow<&RegionHeader::mark>{"layout version, byte order", FieldWriter::maker,
                                   "32 bits each: 5 and `0x01020304`"},
    MemberRow<&RegionHeader::layout_hash>{"layout hash", FieldWriter::maker,
                                          "FNV-1a over the fields of this page"},
    MemberRow<&RegionHeader::kind>{"kind", FieldWriter::maker, "1 waypoints, 2 spline"},
    MemberRow<&RegionHeader::region_bytes>{"region bytes", FieldWriter::maker, "size of the file"},
    MemberRow<&RegionHeader::stream_id>{"stream id", FieldWriter::maker,
                                        "random, not 0; the same in both regions"},
    MemberRow<&RegionHeader::dimensions>{"dimensions", FieldWriter::maker, "D, 1 to 64"},
    MemberRow<&RegionHeader::capacity>{"capacity", FieldWriter::maker,
                                       "ring items or knot slots; a power of two"},
    MemberRow<&RegionHeader::clock>{"clock", FieldWriter::maker, "0 recorded, 1 CLOCK_MONOTONIC"},
    MemberRow<&RegionHeader::time_namespace>{"time namespace", FieldWriter::maker,
                                             "inode of `/proc/self/ns/time` on a live stream"},
    MemberRow<&RegionHeader::control>{"control offset", FieldWriter::maker,
                                      "where the control block begins, in bytes"},
    MemberRow<&RegionHeader::stride>{"stride", FieldWriter::maker,
                                     "bytes from one item or slot to the next"},
    MemberRow<&RegionHeader::min_interval>{"least interval", FieldWriter::maker,
                                           "between waypoints, ns"},
    MemberRow<&RegionHeader::max_interval>{"most interval", FieldWriter::maker, "ns"},
    MemberRow<&RegionHeader::start_kind>{
        "start condition", FieldWriter::maker,
        "0 natural, 1 clamped, 2 halt, 3 velocity, 4 acceleration, 7 the method's own"},
    MemberRow<&RegionHeader::method>{
        "method", FieldWriter::maker,
        "0 c2, 1 hermite, 2 quintic, 4 smoothing, 16 bessel, 17 akima, 18 makima, 19 pchip, 20 "
        "rounded (spline region, as all up to the stop time)"},
    MemberRow<&RegionHeader::settle>{"settle lag", FieldWriter::maker, "K"},
    MemberRow<&RegionHeader::tail>{"tail", FieldWriter::maker,
                                   "0 bessel, 1 parabolic, 2 natural, 3 clamped"},
    MemberRow<&RegionHeader::stop_time>{"stop time", FieldWriter::maker, "ns"},
    MemberRow<&RegionHeader::epoch>{"epoch", FieldWriter::owner,
                                    "number of the owner's life, from 1"},
    MemberRow<&RegionHeader::owner_pid>{"process id", FieldWriter::owner, "of the owner"},
    MemberRow<&RegionHeader::owner_since>{"since", FieldWriter::owner,
                                          "CLOCK_MONOTONIC at which it became the owner"},
    MemberRow<&RegionHeader::lambda>{"lambda", FieldWriter::maker,
                                     "double, s³: of `smoothing` (spline region, as all below)"},
    MemberRow<&RegionHeader::time_scale>{"time scale", FieldWriter::maker,
                                         "double, s: of `rounded`"},
    MemberRow<&RegionHeader::force_lag>{"lag forced", FieldWriter::maker,
                                        "1: a settle lag too short for λ is taken"},
    MemberRow<&RegionHeader::freeze_ahead>{"freeze-ahead", FieldWriter::maker,
                                           "ns, of a live stream"},
    MemberRow<&RegionHeader::history>{"history", FieldWriter::maker, "ns, of a live stream"},
    MemberRow<&RegionHeader::min_entry>{"least entry length", FieldWriter::maker,
                                        "ns, of a live stream"},
    padding(4),
    MemberRow<&RegionHeader::start_value>{"start value", FieldWriter::maker,
                                          "a double per dimension: of the start condition"},
    MemberRow<&RegionHeader::dimension_kind>{"dimension kind", FieldWriter::maker,
                                             "a word per dimension: 0 linear, 1 periodic, 2 "
                                             "quaternion as x y z w, 3 quaternion as w x y z; "
                                             "all four dimensions of a quaternion have the same"},
    MemberRow<&RegionHeader::period>{
        "period", FieldWriter::maker,
        "a double per dimension: of a periodic one, in its unit, 1e-100 to 1e100; else 0"},
    MemberRow<&RegionHeader::name>{"name", FieldWriter::maker,
                                   "32 bytes per dimension, zero-terminated"},
    MemberRow<&RegionHeader::unit>{"unit", FieldWriter::maker,
                                   "16 bytes per dimension, zero-terminated"},
    MemberRow<&RegionHeader::max_velocity>{
        "velocity limit", FieldWriter::maker,
        "a double per dimension, 0 for none (spline region, as all below)"},
    MemberRow<&RegionHeader::max_acceleration>{"acceleration limit", FieldWriter::maker,
                                               "a double per dimension, 0 for none"},
    MemberRow<&RegionHeader::max_jerk>{"jerk limit", FieldWriter::maker,
                                       "a double per dimension, 0 for none"},
    MemberRow<&RegionHeader::lower_bound>{"lower bound", FieldWriter::maker,
                                          "a double per dimension: of the position, −∞ for none; 0 "
                                          "with an upper bound of 0 says that "
                                          "there are no bounds"},
    MemberRow<&RegionHeader::upper_bound>{"upper bound", FieldWriter::maker,
                                          "a double per dimension, +∞ for none"},
    MemberRow<&RegionHeader::beyond>{
        "beyond the limits", FieldWriter::maker,
        "what is done about such a segment: 0 report it, 1 refuse its waypoint"}};
inline constexpr auto kHeaderFields = place(kHeaderRows);
inline constexpr std::size_t kHeaderWords = size_of(kHeaderFields).words;

/// Whether a header's method smooths: then its board's cells and rows have more words.
[[nodiscard]] bool smooths(const RegionHeader& header) noexcept;

/// Copies a header out of a region, word by word, so that a process uses the values that it has
/// checked even if the region changes. The loads are relaxed: the header was written before the
/// region got its name, and the kernel orders the look-up of the name after that. Throws BadRegion
/// if the region is too short to hold one.
[[nodiscard]] RegionHeader copy_header(std::span<const std::byte> region);

/// The same, from at least kHeaderWords words that have already been copied.
[[nodiscard]] RegionHeader decode_header(std::span<const Word> words) noexcept;

/// Writes a header into a region that has no name yet.
void write_header(std::span<std::byte> region, const RegionHeader& header) noexcept;

/// The kinds of a header's dimensions, one each; the header's numbers must be kinds.
[[nodiscard]] std::vector<Dimension> dimensions_of(const RegionHeader& header);

/// A name or unit of a header, up to its first zero byte.
template <std::size_t N>
[[nodiscard]] std::string text_of(const std::array<char, N>& bytes) {
  std::size_t length = 0;
  while (length < N && bytes[length] != 0) ++length;
  return {bytes.data(), length};
}

}  // namespace splinecast::ipc
