#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "ipc/layout/table.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::ipc {

/// The numbers that identify a stream's region and its layout. The tables of this folder define the
/// place of every word of the regions; docs/layout-fields.md is generated from them. A release that
/// changes a row adds 1 to kLayoutVersion. Between releases the layout hash distinguishes layouts.
inline constexpr std::uint64_t kMagic = 0x54534143'4e4c5053;  // "SPLNCAST" in memory order
inline constexpr std::uint32_t kLayoutVersion = 7;
inline constexpr std::uint32_t kByteOrder = 0x01020304;

/// The two numbers of the header's second word. All layout versions have them at this place, so
/// that each version recognises a region of another version.
struct LayoutMark {
  std::uint32_t version = kLayoutVersion;
  std::uint32_t byte_order = kByteOrder;
};

inline constexpr std::size_t kNameBytes = 32;
inline constexpr std::size_t kUnitBytes = 16;
inline constexpr std::size_t kLawNameBytes = 136;

/// Upper bound of the largest rate of a time law.
inline constexpr double kLargestRate = 100;

/// The rules by which a solver chooses lengths of stops, and accelerations at the begin of stops
/// and entries. From 2 on, verification reads both from the record, and checks what a solver
/// promises about them (verification/promises); by the former rules it computes them.
inline constexpr std::uint64_t kFormerRules = 1;
inline constexpr std::uint64_t kRules = 2;

/// The first words of each region, as kHeaderRows places them. A commander or stopper region has
/// only those that every region needs: the others are 0.
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
  std::uint64_t is_law = 0;       ///< 1: the stream is a time law
  std::int64_t law_origin = 0;    ///< of a law: stream time in ns at its value 0
  double largest_rate = 0;        ///< of a law, or of the law that the stream follows
  std::uint64_t law_id = 0;       ///< stream id of the law that the stream follows; 0: none
  std::array<double, kMaxDimensions> start_value{};
  std::array<std::uint64_t, kMaxDimensions> dimension_kind{};  ///< DimensionKind
  std::array<double, kMaxDimensions> period{};                 ///< of `periodic`; else 0
  std::array<std::array<char, kNameBytes>, kMaxDimensions> name{};
  std::array<std::array<char, kUnitBytes>, kMaxDimensions> unit{};
  std::array<char, kLawNameBytes> law{};              ///< name of the law that the stream follows
  std::array<double, kMaxDimensions> max_velocity{};  ///< 0: no limit, as in the next two
  std::array<double, kMaxDimensions> max_acceleration{};
  std::array<double, kMaxDimensions> max_jerk{};
  std::array<double, kMaxDimensions> lower_bound{};  ///< both bounds 0: none
  std::array<double, kMaxDimensions> upper_bound{};
  std::uint64_t beyond = 0;  ///< Beyond
  std::uint64_t rules = 0;   ///< kFormerRules … kRules
};

inline constexpr std::tuple kHeaderRows{
    MemberRow<&RegionHeader::magic>{"magic", FieldWriter::maker, "the characters `SPLNCAST`"},
    MemberRow<&RegionHeader::mark>{"layout version, byte order", FieldWriter::maker,
                                   "32 bits each: 7 and `0x01020304`"},
    MemberRow<&RegionHeader::layout_hash>{
        "layout hash", FieldWriter::maker,
        "64-bit FNV-1a of all names, offsets, sizes and writers on this page"},
    MemberRow<&RegionHeader::kind>{"kind", FieldWriter::maker,
                                   "1 waypoints region, 2 spline region, 3 commander region,\n"
                                   "4 stopper region"},
    MemberRow<&RegionHeader::region_bytes>{"region bytes", FieldWriter::maker,
                                           "size of the file, in bytes"},
    MemberRow<&RegionHeader::stream_id>{"stream id", FieldWriter::maker,
                                        "random, not 0; the same in both regions of a stream"},
    MemberRow<&RegionHeader::dimensions>{"dimensions", FieldWriter::maker, "D, 1 to 64"},
    MemberRow<&RegionHeader::capacity>{
        "capacity", FieldWriter::maker,
        "number of ring items, or of slots of numbered knots; a power of two"},
    MemberRow<&RegionHeader::clock>{"clock", FieldWriter::maker,
                                    "0 recorded stream, 1 live stream (CLOCK_MONOTONIC),\n"
                                    "2 live stream that follows a time law"},
    MemberRow<&RegionHeader::time_namespace>{"time namespace", FieldWriter::maker,
                                             "of a live stream: inode of `/proc/self/ns/time`"},
    MemberRow<&RegionHeader::control>{"control offset", FieldWriter::maker,
                                      "offset of the control block, in bytes"},
    MemberRow<&RegionHeader::stride>{"stride", FieldWriter::maker,
                                     "bytes from one item or slot to the next"},
    MemberRow<&RegionHeader::min_interval>{"least interval", FieldWriter::maker,
                                           "ns: shortest interval between two waypoints"},
    MemberRow<&RegionHeader::max_interval>{"most interval", FieldWriter::maker,
                                           "ns: longest interval between two waypoints"},
    MemberRow<&RegionHeader::start_kind>{
        "start condition", FieldWriter::maker,
        "0 natural, 1 clamped, 2 halt, 3 velocity, 4 acceleration, 7 the method's default"},
    MemberRow<&RegionHeader::method>{
        "method", FieldWriter::maker,
        "0 c2, 1 hermite, 2 quintic, 4 smoothing, 16 bessel, 17 akima, 18 makima,\n"
        "19 pchip, 20 rounded\n"
        "in a spline region only, as all fields up to the stop time"},
    MemberRow<&RegionHeader::settle>{"settle lag", FieldWriter::maker,
                                     "K: an append does not change a knot that has K newer ones"},
    MemberRow<&RegionHeader::tail>{
        "tail", FieldWriter::maker,
        "end condition at the newest knot: 0 bessel, 1 parabolic, 2 natural, 3 clamped"},
    MemberRow<&RegionHeader::stop_time>{
        "stop time", FieldWriter::maker,
        "ns: length of a stop segment; longer if a limit requires it"},
    MemberRow<&RegionHeader::epoch>{"epoch", FieldWriter::owner,
                                    "number of owners so far, this one included"},
    MemberRow<&RegionHeader::owner_pid>{"process id", FieldWriter::owner, "of the owner"},
    MemberRow<&RegionHeader::owner_since>{
        "since", FieldWriter::owner, "ns by CLOCK_MONOTONIC: when this process became the owner"},
    MemberRow<&RegionHeader::lambda>{
        "lambda", FieldWriter::maker,
        "double, s³, of `smoothing`\n"
        "in a spline region only, as all fields up to the least entry length"},
    MemberRow<&RegionHeader::time_scale>{"time scale", FieldWriter::maker,
                                         "double, s, of `rounded`"},
    MemberRow<&RegionHeader::force_lag>{"lag forced", FieldWriter::maker,
                                        "1: a settle lag that is too short for λ is accepted"},
    MemberRow<&RegionHeader::freeze_ahead>{"freeze-ahead", FieldWriter::maker,
                                           "ns: a live stream settles this long ahead of now"},
    MemberRow<&RegionHeader::history>{
        "history", FieldWriter::maker,
        "ns: a live stream keeps segments that ended less than this ago"},
    MemberRow<&RegionHeader::min_entry>{"least entry length", FieldWriter::maker,
                                        "ns: length of the shortest entry of a live stream"},
    MemberRow<&RegionHeader::is_law>{"time law", FieldWriter::maker,
                                     "1: the stream is a time law: its value is stream time in s\n"
                                     "in both regions, as all fields up to the law's name"},
    MemberRow<&RegionHeader::law_origin>{"law's origin", FieldWriter::maker,
                                         "of a time law: stream time in ns at its value 0"},
    MemberRow<&RegionHeader::largest_rate>{
        "largest rate", FieldWriter::maker,
        "double, of a time law, or of the law that the stream follows"},
    MemberRow<&RegionHeader::law_id>{"law's id", FieldWriter::maker,
                                     "stream id of the law that the stream follows; 0: none"},
    MemberRow<&RegionHeader::start_value>{
        "start value", FieldWriter::maker,
        "a double per dimension: velocity or acceleration of the start condition"},
    MemberRow<&RegionHeader::dimension_kind>{
        "dimension kind", FieldWriter::maker,
        "a word per dimension: 0 linear, 1 periodic, 2 quaternion as x y z w,\n"
        "3 quaternion as w x y z; the four dimensions of a quaternion have the same"},
    MemberRow<&RegionHeader::period>{
        "period", FieldWriter::maker,
        "a double per dimension: of a periodic one 1e-100 to 1e100, in its unit; else 0"},
    MemberRow<&RegionHeader::name>{"name", FieldWriter::maker,
                                   "32 bytes per dimension: text, zero-terminated"},
    MemberRow<&RegionHeader::unit>{"unit", FieldWriter::maker,
                                   "16 bytes per dimension: text, zero-terminated"},
    MemberRow<&RegionHeader::law>{"law", FieldWriter::maker,
                                  "136 bytes: name of the law that the stream follows"},
    MemberRow<&RegionHeader::max_velocity>{"velocity limit", FieldWriter::maker,
                                           "a double per dimension, 0: no limit\n"
                                           "in a spline region only, as all fields below"},
    MemberRow<&RegionHeader::max_acceleration>{"acceleration limit", FieldWriter::maker,
                                               "a double per dimension, 0: no limit"},
    MemberRow<&RegionHeader::max_jerk>{"jerk limit", FieldWriter::maker,
                                       "a double per dimension, 0: no limit"},
    MemberRow<&RegionHeader::lower_bound>{
        "lower bound", FieldWriter::maker,
        "a double per dimension: of the position, −∞: no lower bound\n"
        "lower and upper bound both 0: no bounds"},
    MemberRow<&RegionHeader::upper_bound>{
        "upper bound", FieldWriter::maker,
        "a double per dimension: of the position, +∞: no upper bound"},
    MemberRow<&RegionHeader::beyond>{
        "beyond the limits", FieldWriter::maker,
        "a waypoint with which the curve exceeds a limit is: 0 reported, 1 refused\n"
        "2 and 3 are reserved"},
    MemberRow<&RegionHeader::rules>{
        "rules", FieldWriter::maker,
        "number of the rules of stops and entries that the solver follows: 2\n"
        "1 in old recordings only"}};
inline constexpr auto kHeaderFields = place(kHeaderRows);
inline constexpr std::size_t kHeaderWords = size_of(kHeaderFields).words;
inline constexpr std::size_t kEpoch = word_of(kHeaderFields, "epoch");
inline constexpr std::size_t kOwnerPid = word_of(kHeaderFields, "process id");
inline constexpr std::size_t kOwnerSince = word_of(kHeaderFields, "since");

/// The largest rate of a law, or of the law that the stream follows.
[[nodiscard]] inline double max_rate(const RegionHeader& header) noexcept {
  return header.largest_rate;
}

/// Whether a header's method smooths: then its board's cells and rows have more words.
[[nodiscard]] bool smooths(const RegionHeader& header) noexcept;

/// Copies a header out of a region, word by word, so that a process uses the values that it has
/// checked even if the region changes. The loads are acquire, in the order of the words: the epoch
/// before the other words of the owner, see enter_owner(). For the words of the maker, relaxed
/// would be enough: they were written before the region got its name, and the kernel orders the
/// look-up of the name after that. Throws BadRegion if the region is too short to hold one.
[[nodiscard]] RegionHeader copy_header(std::span<const std::byte> region);

/// Decodes a header from words that have already been copied: at least kHeaderWords.
[[nodiscard]] RegionHeader decode_header(std::span<const Word> words) noexcept;

/// Writes a header into a region that has no name yet.
void write_header(std::span<std::byte> region, const RegionHeader& header) noexcept;

/// The dimensions of a header: the kind and period of each. Each number in `dimension_kind` must be
/// a DimensionKind.
[[nodiscard]] std::vector<Dimension> dimensions_of(const RegionHeader& header);

/// A name or unit of a header, up to its first zero byte.
template <std::size_t N>
[[nodiscard]] std::string text_of(const std::array<char, N>& bytes) {
  std::size_t length = 0;
  while (length < N && bytes[length] != 0) ++length;
  return {bytes.data(), length};
}

}  // namespace splinecast::ipc
