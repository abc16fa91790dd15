#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/limits/named.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/waypoint_ring.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// What a producer fixes about its stream.
struct ProducerOptions {
  std::size_t dimensions = 1;            ///< 1 to 64
  std::vector<std::string> names{};      ///< one per dimension, or none: up to 31 bytes each
  std::vector<std::string> units{};      ///< likewise, up to 15 bytes each
  std::vector<core::Dimension> kinds{};  ///< one per dimension, or none: all linear
  StreamClock clock = StreamClock::monotonic;
  core::Condition start{.kind = core::ConditionKind::halt, .value = {}};
  IngestLimits limits{};
  std::size_t capacity = 1024;  ///< ring items; rounded up to a power of two, at most 2²⁴
  RegionAccess access{};
  Trust trust{};
};

/// What a solver fixes about its curve. What is unset takes its default on a new board; a solver
/// that takes a board over takes its options too, and may not contradict them.
struct SolverOptions {
  const core::Method* method = nullptr;   ///< default c2; one that streams
  std::optional<double> lambda{};         ///< of smoothing, which needs it: λ ≥ 0 in s³
  std::optional<double> time_scale{};     ///< of rounded; default 1 s
  std::optional<std::size_t> settle{};    ///< settle lag K; default core::default_settle
  std::optional<core::Tail> tail{};       ///< default bessel
  bool force_lag = false;                 ///< take a lag that is too short for λ
  std::optional<core::Time> stop_time{};  ///< length of the stop tail; default 250 ms. With limits:
                                          ///< its least length, default 1 ms
  std::optional<core::MotionLimits> limits{};  ///< lists of one value per dimension or one for all
  std::vector<core::NamedLimits>
      named_limits{};                        ///< of dimensions by name, where `limits` has none
                                             ///< of the kind; other names are of no effect
  std::optional<core::Beyond> beyond{};      ///< default report
  std::optional<core::Time> freeze_ahead{};  ///< live: what lies this long ahead settles; 5 ms
  std::optional<core::Time> history{};       ///< live: what ended less than this ago is kept; 1 s
  std::optional<core::Time> min_splice{};    ///< live: shortest splice; default as freeze_ahead
  std::optional<std::size_t> capacity{};     ///< segments of history; default 4,096
  bool wake = true;  ///< wake waiting readers: one system call a revision, which wakes
                     ///< at most kWokenAtOnce threads
  RegionAccess access{};
  Trust trust{};
};

/// A header for a new region, all but what depends on its kind and capacity.
[[nodiscard]] RegionHeader make_header(const ProducerOptions& options, std::uint64_t stream_id);

/// What a header says of the stream: the options that its producer gave.
[[nodiscard]] core::Condition start_condition(const RegionHeader& header);
[[nodiscard]] std::vector<std::string> dimension_names(const RegionHeader& header);
[[nodiscard]] std::vector<std::string> dimension_units(const RegionHeader& header);
[[nodiscard]] core::DimensionKinds dimension_kinds(const RegionHeader& header);
[[nodiscard]] IngestLimits ingest_limits(const RegionHeader& header) noexcept;
[[nodiscard]] StreamClock stream_clock(const RegionHeader& header) noexcept;

/// What a header says of the curve: the options that its solver gave.
[[nodiscard]] core::WindowOptions window_options(const RegionHeader& header);

/// Limits that the options ask for on the stream of this header. Throws BadRequest if they do not
/// go with its dimensions.
[[nodiscard]] core::MotionLimits limits_for(const SolverOptions& options,
                                            const RegionHeader& header);

/// The name that a header has of a dimension: cut to kNameBytes − 1 bytes, between characters.
[[nodiscard]] std::string header_name(const std::string& name);

/// What a header says of how a live stream is solved; nothing for a recorded one.
[[nodiscard]] std::optional<LiveOptions> live_options(const RegionHeader& header) noexcept;

/// Throws BadRegion, naming both, if a live stream's clock is another time namespace's.
void require_same_clock(const RegionHeader& header, const std::string& stream);

/// Throws BadRegion, naming what differs, unless a board describes the stream of this ring as the
/// ring does: stream id, dimensions, their kinds, clock and start.
void require_same_stream(const RegionHeader& ring, const RegionHeader& board);

/// Enters this process as the region's owner and counts its epoch up. Relaxed, like copy_header:
/// the three words are for people, and a copy made meanwhile may hold some of the owner before.
void enter_owner(std::span<std::byte> region, const RegionHeader& before) noexcept;

}  // namespace splinecast::ipc
