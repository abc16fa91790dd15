#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "splinecast/core/dimension_kind.hpp"
#include "splinecast/core/segment.hpp"
#include "splinecast/core/state.hpp"
#include "splinecast/ipc/names.hpp"
#include "splinecast/ipc/word.hpp"

/// Where every word of the two regions lies. README.md of this folder describes the same bytes in
/// words; the static_asserts below hold both to it.
namespace splinecast::ipc {

inline constexpr std::uint64_t kMagic = 0x54534143'4e4c5053;  // "SPLNCAST" in memory order
inline constexpr std::uint32_t kLayoutVersion = 3;
inline constexpr std::uint32_t kByteOrder = 0x01020304;

/// What different processes write, or poll, lies this far apart: two cache lines, because adjacent
/// lines are fetched in pairs.
inline constexpr std::size_t kSeparation = 128;
inline constexpr std::size_t kCacheLine = 64;
inline constexpr std::size_t kPage = 4096;

inline constexpr std::size_t kNameBytes = 32;
inline constexpr std::size_t kUnitBytes = 16;

/// The first bytes of both regions. Everything but epoch, owner_pid and owner_since is written
/// before the region gets its name, and never again.
struct RegionHeader {
  std::uint64_t magic;
  std::uint32_t layout_version;
  std::uint32_t byte_order;
  std::uint64_t layout_hash;
  std::uint64_t kind;            ///< RegionKind
  std::uint64_t region_bytes;    ///< size of the whole region
  std::uint64_t stream_id;       ///< random; the same in both regions of a stream
  std::uint64_t dimensions;      ///< 1 … 64
  std::uint64_t order;           ///< coefficients stored per dimension: 6
  std::uint64_t capacity;        ///< ring items or segment slots, a power of two
  std::uint64_t clock;           ///< StreamClock
  std::uint64_t time_namespace;  ///< inode of the time namespace of a live stream's clock
  std::uint64_t control;         ///< offset of the control lines
  std::uint64_t stride;          ///< bytes from one ring item or segment slot to the next
  std::int64_t min_interval;     ///< ns between waypoints
  std::int64_t max_interval;
  std::uint64_t start_kind;  ///< core::ConditionKind at the first waypoint
  std::uint64_t method;      ///< core::Method::number; 0: c2
  std::uint64_t settle;      ///< settle lag K
  std::uint64_t tail;        ///< core::Tail
  std::int64_t stop_time;    ///< ns
  std::uint64_t epoch;       ///< number of the owner's life, from 1
  std::uint64_t owner_pid;
  std::int64_t owner_since;   ///< CLOCK_MONOTONIC when the owner took the region
  double lambda;              ///< of smoothing, s³
  double time_scale;          ///< of rounded, s
  std::uint64_t force_lag;    ///< 1: a lag too short for lambda is taken
  std::int64_t freeze_ahead;  ///< ns that a live stream settles ahead of now
  std::int64_t history;       ///< ns before now that a live stream keeps
  std::int64_t min_splice;    ///< ns: length of the shortest splice
  std::array<std::uint64_t, 3> reserved;
  std::array<double, core::kMaxDimensions> start_value;
  std::array<std::uint64_t, core::kMaxDimensions> dimension_kind;  ///< core::DimensionKind
  std::array<double, core::kMaxDimensions> period;                 ///< of `wrap`; else 0
  std::array<std::array<char, kNameBytes>, core::kMaxDimensions> name;
  std::array<std::array<char, kUnitBytes>, core::kMaxDimensions> unit;
  std::array<double, core::kMaxDimensions> max_acceleration;  ///< 0: no limit
  std::array<std::uint64_t, 192> reserved_to_end;
};
static_assert(sizeof(RegionHeader) == 2 * kPage - 1280);
inline constexpr std::size_t kHeaderBytes = 2 * kPage;
static_assert(offsetof(RegionHeader, epoch) == 160);
static_assert(offsetof(RegionHeader, start_value) == 256);
static_assert(offsetof(RegionHeader, dimension_kind) == 768);
static_assert(offsetof(RegionHeader, period) == 1280);
static_assert(offsetof(RegionHeader, name) == 1792);
static_assert(offsetof(RegionHeader, unit) == 3840);
static_assert(offsetof(RegionHeader, freeze_ahead) == 208);
static_assert(offsetof(RegionHeader, max_acceleration) == 4864);

/// The page behind the header holds four control lines, kSeparation apart. They begin at an offset
/// that differs from stream to stream, so that a sweep over many streams does not hit one cache
/// set.
inline constexpr std::size_t kControlLines = 4;
inline constexpr std::size_t kControlPositions = kPage / kSeparation - kControlLines;
inline constexpr std::size_t kBodyOffset = kHeaderBytes + kPage;

/// Words of the control lines, in words from the control offset.
inline constexpr std::size_t kRevision = 0;  ///< spline: the commit word
inline constexpr std::size_t kHead = 0;      ///< waypoints: items appended
inline constexpr std::size_t kRetired = 1;   ///< both: not 0 once the region is of no more use
inline constexpr std::size_t kClaimed = 2;   ///< waypoints: items up to which a replacement writes
inline constexpr std::size_t kTail = kSeparation / sizeof(Word);  ///< spline: items consumed
inline constexpr std::size_t kLate = kTail + 1;  ///< spline: last revision committed too late
inline constexpr std::size_t kChecked =
    kTail + 2;  ///< spline: last revision of which that is known
inline constexpr std::size_t kSleeping = 2 * kSeparation / sizeof(Word);  ///< spline: solver sleeps
inline constexpr std::size_t kProducerCounters = kSeparation / sizeof(Word);  ///< waypoints

/// Ring items: kind and flags, time, then position, velocity and acceleration of D words each.
inline constexpr std::size_t kItemKind = 0;
inline constexpr std::size_t kItemTime = 1;
inline constexpr std::size_t kItemValues = 2;

/// Words of a segment's cell before its coefficients; the tag must come first.
inline constexpr std::size_t kCellTag = 0;
inline constexpr std::size_t kCellNumber = 1;
inline constexpr std::size_t kCellLeft = 2;
inline constexpr std::size_t kCellRight = 3;
inline constexpr std::size_t kCellShape = 4;  ///< order | kind << 8 | newer knots seen << 16 |
                                              ///< (1 << 48 if a waypoint stands at the left end)
inline constexpr std::size_t kCellRightSeen = 5;  ///< newer knots that its right knot had seen
inline constexpr std::size_t kCellItem = 6;  ///< of a splice: item of the run's first waypoint + 1
inline constexpr std::size_t kCellCoefficients = 8;
inline constexpr std::size_t kCellExtraWords = 4;  ///< γ, and the smoothing row: pivot, L1, L2

/// Words of a head cell.
inline constexpr std::size_t kHeadFirst = 1;
inline constexpr std::size_t kHeadNewest = 2;
inline constexpr std::size_t kHeadSettledUntil = 3;
inline constexpr std::size_t kHeadFlags =
    4;  ///< bit 0: finished, 1: the run was entered, 2: starved
inline constexpr std::size_t kHeadChangedFrom = 5;
inline constexpr std::size_t kHeadConsumed = 6;
inline constexpr std::size_t kHeadKnots = 7;
inline constexpr std::size_t kHeadNewestKnot = 8;
inline constexpr std::size_t kHeadCommitted = 9;
inline constexpr std::size_t kHeadRefused = 10;
inline constexpr std::size_t kHeadRun = 11;  ///< number of the first segment of the run
inline constexpr std::size_t kHeadRunKnots = 12;
inline constexpr std::size_t kHeadLowWater = 13;
inline constexpr std::size_t kHeadUnderruns = 14;
inline constexpr std::size_t kHeadMisses = 15;
inline constexpr std::size_t kHeadRevisions = 16;
inline constexpr std::size_t kHeadWithdrawn = 17;
inline constexpr std::size_t kHeadControls = 18;
inline constexpr std::size_t kHeadRunFrozen = 19;
inline constexpr std::size_t kHeadReasons = 24;  ///< a counter per Refusal
inline constexpr std::size_t kRefusalReasons = 16;
inline constexpr std::size_t kHeadChanges = 40;  ///< changed_from of revision r at r mod 64
inline constexpr std::size_t kHeadChangesKept = 64;
inline constexpr std::size_t kHeadWords = kHeadChanges + kHeadChangesKept;

/// The ring of refusals beside the head: item number << 8 | reason.
inline constexpr std::size_t kRefusalsKept = 1024;

/// Identifies all of the above; other numbers are another layout.
[[nodiscard]] std::uint64_t layout_hash() noexcept;

/// Offsets of a waypoint ring, derived from what its header fixes; all in bytes.
struct RingLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  std::size_t items;
  std::size_t stride;
  std::size_t bytes;

  [[nodiscard]] static RingLayout of(std::size_t dimensions, std::size_t capacity,
                                     std::size_t control) noexcept;
};

/// Offsets of a segment board.
struct BoardLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  std::size_t head;      ///< two cells of kHeadWords words
  std::size_t refusals;  ///< kRefusalsKept words
  std::size_t times;     ///< packed knot times: capacity words
  std::size_t slots;     ///< capacity slots of two cells
  std::size_t cell;      ///< bytes of a cell
  std::size_t stride;    ///< bytes of a slot
  std::size_t bytes;

  [[nodiscard]] static BoardLayout of(std::size_t dimensions, std::size_t capacity,
                                      std::size_t control) noexcept;
};

/// Largest capacities, so that every size and index computed from a header fits.
inline constexpr std::size_t kMaxRingCapacity = std::size_t{1} << 24;
inline constexpr std::size_t kMaxBoardCapacity = std::size_t{1} << 22;

/// Longest stop tail: so short that a stop, and the way back behind it, can be added to any time.
inline constexpr core::Time kLongestStop{std::int64_t{1} << 60};

/// Copies a header out of a region, word by word: what a process checks is what it then uses,
/// whatever happens to the region meanwhile. Its loads are relaxed: the header was written before
/// the region got its name, and the kernel has put the look-up of that name behind it. Throws
/// BadRegion if the region is too short to hold one.
[[nodiscard]] RegionHeader copy_header(std::span<const std::byte> region);

/// Throws BadRegion, naming the offending value, unless the copied header describes a region of
/// this kind, layout, byte order and real size. Returns its layout.
RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes);
BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes);

/// The kinds of a header's dimensions, one each; the header's numbers must be kinds.
[[nodiscard]] std::vector<core::Dimension> dimensions_of(const RegionHeader& header);

/// A name or unit of a header, up to its first zero byte.
template <std::size_t N>
[[nodiscard]] std::string text_of(const std::array<char, N>& bytes) {
  std::size_t length = 0;
  while (length < N && bytes[length] != 0) ++length;
  return {bytes.data(), length};
}

}  // namespace splinecast::ipc
