#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/forms/splice.hpp"
#include "core/limits/check.hpp"
#include "core/online/extrapolation.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

/// What an entry must keep.
struct EntryRules {
  const MotionLimits* limits = nullptr;  ///< given ones
  const MotionLimits* shown = nullptr;   ///< velocities and accelerations that stand for those of a
                                         ///< dimension without an acceleration limit: see
                                         ///< EntrySearch; null: any
  Time least{};                          ///< shortest entry
  std::size_t newer = 0;     ///< newer knots that must be known of one at which an entry ends
  bool goes_beyond = false;  ///< what lies beyond the newest knot counts too
};

/// The end of an entry. Spans are the search's own, until it is used again.
struct EntryEnd {
  std::optional<std::size_t> knot{};  ///< of the target; none: beyond the newest one
  std::size_t known = 0;              ///< knots that the target had
  Instant state{};
  Time line_end{};  ///< beyond the newest: when the straight line ends; not later than the state if
                    ///< that lies in the stop, or at rest
  Time rest{};      ///< beyond the newest: when the stop has come to rest
};

/// Segments of a target that starts at rest in which that start has faded to less than a fiftieth.
inline constexpr std::size_t kStartFades = 3;

/// Looks for the entry by which a curve goes on from a state onto the *target*: the spline through
/// the knots of a run, and behind the newest one its Extrapolation.
///
/// An entry is the quintic from the state to the target's state at its end. Candidates for the end
/// are, in this order, the target's knots that are still in the window, then times beyond the
/// newest one, each duration kGrowth times the one before, up to kLongest. Taken is the first one
/// for which the quintic and everything behind it keep the limits; if there is none, the first one
/// for which the quintic itself does.
///
/// The velocity of the newest knot, unless it is given, is a guess until the next one is known. An
/// entry to it is one of those beyond the newest knot, the shortest, onto the beginning of the
/// straight line.
///
/// What a motion has *shown* is an estimate. What a dimension has at either end of an entry is
/// never beyond it, nor a motion over the way in a second, nor what the entry that is made again
/// has; what lies behind the entry is not compared with it; and an entry of kLongest need not keep
/// it.
///
/// The search can be interrupted after any candidate: what it has refused it does not try again
/// until `restart`. A candidate that cannot pass, because the mean acceleration or velocity that it
/// needs is beyond its limit, costs O(D) and does not count as one that was tried; there are at
/// most K + 2 knots and 170 durations. Allocates when made only; one thread uses it.
class EntrySearch {
 public:
  static constexpr Time kLongest{3'000'000'000};
  static constexpr double kGrowth = 1.05;

  enum class Outcome {
    more,   ///< candidates that are known are left
    found,  ///< `end` is the entry's
    none,   ///< no candidate that is known passes
  };

  EntrySearch(std::size_t dimensions, DimensionKinds kinds);

  /// Begins with the target's knot `first` again.
  void restart(std::size_t first) noexcept;

  /// The same in place of an entry from one state to another, beyond the newest knot. O(D).
  void restart(std::size_t first, const Instant& from, const Instant& end) noexcept;

  /// Tries candidates until one passes, none is left, or `tries` of them have been tried; counts
  /// `tries` down. `from` is the state now, which may have moved on since the last call.
  Outcome search(const SlidingWindow& target, const Instant& from, const EntryRules& rules,
                 int& tries) noexcept;

  /// The same for a state at which the curve is to end: at its own time, else later, as much later
  /// as it takes. `restart` comes first.
  Outcome search_rest(const Instant& rest, const Instant& from, const EntryRules& rules,
                      int& tries) noexcept;

  /// Whether a target that starts at rest with its knot 0, which is in the window, keeps the limits
  /// as far as it is known; and, where none is given, whether its first segment stays below three
  /// times what the segments behind show, or, of fewer than four, the first three waypoints.
  [[nodiscard]] bool keeps_start(const SlidingWindow& target, const EntryRules& rules) noexcept;

  /// The end found by the last search.
  [[nodiscard]] const EntryEnd& end() const noexcept { return end_; }

  /// The entry found by the last search.
  [[nodiscard]] const Segment& entry() const noexcept { return entry_; }

 private:
  enum class Verdict { passes, exceeds, untried };

  [[nodiscard]] Outcome search_knots(const SlidingWindow& target, const Instant& from,
                                     const EntryRules& rules, int& tries) noexcept;
  [[nodiscard]] Outcome search_beyond(const SlidingWindow& target, const Instant& from,
                                      const EntryRules& rules, int& tries) noexcept;
  [[nodiscard]] Outcome fall_back(const SlidingWindow& target, const Instant& from,
                                  const EntryRules& rules) noexcept;
  [[nodiscard]] Verdict judge(const Instant& from, const EntryRules& rules, int& tries) noexcept;
  void end_at_knot(const SlidingWindow& target, std::size_t knot) noexcept;
  void end_beyond(const SlidingWindow& target, Time t) noexcept;
  [[nodiscard]] bool keeps_behind(const SlidingWindow& target, const MotionLimits& limits) noexcept;
  [[nodiscard]] bool keeps_beyond(const MotionLimits& limits) noexcept;
  void allow(const Instant& from, const EntryRules& rules) noexcept;
  void write_of_dimensions(const auto& velocity_of, const auto& acceleration_of,
                           const auto& write) const noexcept;
  void allow_shown(const Instant& from, const EntryRules& rules) noexcept;
  [[nodiscard]] bool keeps_length() const noexcept;
  [[nodiscard]] bool is_out_of_reach(const Instant& from) const noexcept;
  [[nodiscard]] bool passes(const Instant& from) noexcept;
  [[nodiscard]] bool passes_at_last(const Instant& from, const EntryRules& rules) noexcept;
  [[nodiscard]] std::optional<Time> next_duration(Time from, Time to_newest, bool tries_newest,
                                                  Time shortest) noexcept;

  DimensionKinds kinds_;
  std::size_t next_knot_ = 0;
  std::optional<Time> former_end_;  ///< of the entry that is made again, if it ended beyond
  double duration_ = 0;             ///< s, of the last one beyond that was tried; 0: none yet
  bool is_longest_ = false;
  std::optional<std::size_t> fallback_knot_;
  std::optional<std::size_t> last_beyond_;  ///< last segment of the target beyond the limits
  bool knows_behind_ = false;
  EntryEnd end_;
  State end_state_;
  State rest_;            ///< scratch
  MotionLimits allowed_;  ///< of the present entry
  MotionLimits granted_;  ///< what the entry that is made again has, where none are given
  Segment entry_;
  Segment behind_;  ///< scratch
  Extrapolation extrapolation_;
};

}  // namespace splinecast::core
