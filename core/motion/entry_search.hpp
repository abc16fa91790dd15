#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/forms/entry.hpp"
#include "core/limits/check.hpp"
#include "core/limits/position_range.hpp"
#include "core/motion/entry_end.hpp"
#include "core/motion/extrapolation.hpp"
#include "core/motion/trial.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

/// What an entry must respect.
struct EntryRules {
  const MotionLimits* limits = nullptr;  ///< given limits, at the largest rate of a time law
  const MotionLimits* path_limits =
      nullptr;                          ///< those of the target, at the rate 1; null: `limits`
  const MotionLimits* shown = nullptr;  ///< limits shown by the motion: see EntrySearch; null: none
  Time least{};                         ///< shortest duration of an entry
  std::size_t newer = 0;  ///< an entry may end at a knot only if this many newer knots are known
  bool may_end_ahead = false;  ///< the entry may also end after the newest knot
  /// Positions that the published curve reaches anyway after the begin of the entry. Outside the
  /// bounds the entry may go as far, but not farther. Null: none.
  const PositionRange* reach = nullptr;
  bool stays_between = false;  ///< instead of the bounds, the positions at the ends count
  /// If no candidate passes, the entry may end where the target after it exceeds a limit.
  bool falls_back = true;
  bool checks_stop = false;  ///< the target's stop counts, too: see excess_of_stop()

  [[nodiscard]] const MotionLimits& of_path() const noexcept {
    return path_limits != nullptr ? *path_limits : *limits;
  }
};

/// Number of segments after which the effect of a start at rest on the target is below 1/50.
inline constexpr std::size_t kStartFades = 3;

/// Searches for the entry from a state onto the *target*: the spline through the knots of a run
/// and, after the newest one, its Extrapolation.
///
/// An entry is the quintic from the state to the target's state at its end. Candidates for the end
/// are, in this order, the target's knots that are still in the window, then times after the newest
/// one, each duration kGrowth times the previous one, up to kLongest. The search takes the first
/// candidate for which the quintic and everything after it respect the limits. If there is none and
/// the entry may end after the newest knot, it takes the first knot for which the quintic itself
/// respects them, unless the rules exclude this.
///
/// The velocity of the newest knot, unless given, is an estimate until the next knot is known. The
/// search therefore treats an entry to that knot as one that ends after it: as the shortest of
/// these, which ends at the beginning of the straight line.
///
/// The velocities and accelerations that a motion has *shown* are estimates. They limit the entry
/// in a dimension without an acceleration limit. An entry may always have the values at its two
/// ends, those of a motion over its distance in 1 s, and those of the entry that it replaces.
/// Segments after the entry are not compared with them, and an entry of kLongest may exceed them.
///
/// The search can be interrupted after any candidate; it does not try a rejected one again until
/// `restart`. A candidate that needs a mean acceleration or velocity above its limit cannot pass:
/// it costs O(D) and does not count as tried. There are at most K + 2 knots and 450 durations, 170
/// from a shortest entry of 1 ms on. Only the constructor allocates. Not thread-safe: one thread
/// uses it.
class EntrySearch {
 public:
  static constexpr Time kLongest{3'000'000'000};
  static constexpr double kGrowth = 1.05;

  enum class Outcome {
    more,   ///< some known candidates have not been tried
    found,  ///< `end` is the end of the entry
    none,   ///< no known candidate passes
  };

  EntrySearch(std::size_t dimensions, DimensionKinds kinds);

  /// Restarts at knot `first` of the target.
  void restart(std::size_t first) noexcept;

  /// The same, to recompute an entry from `from` to `end`, where `end` was after the newest knot.
  /// O(D).
  void restart(std::size_t first, const Instant& from, const Instant& end) noexcept;

  /// Tries candidates until one passes, none is left, or `tries` of them have been tried; counts
  /// `tries` down. `from` is the current state, which may be later than in the last call.
  Outcome search(const SlidingWindow& target, const Instant& from, const EntryRules& rules,
                 int& tries) noexcept;

  /// The same with one end, the state `rest` at which the curve ends: tries the time of `rest`,
  /// then later ones until a duration exceeds `longest`. The entry also remains within the range of
  /// `rules.reach` and the positions at its two ends. `none` if `rest` is outside the bounds. Call
  /// `restart` first.
  Outcome search_rest(const Instant& rest, const Instant& from, const EntryRules& rules,
                      Time longest, int& tries) noexcept;

  /// Writes the limit of acceleration of each dimension: the given one, else the shown one; of a
  /// quaternion, that of its first dimension counts. O(D).
  void write_accelerations(const MotionLimits& limits, const MotionLimits& shown,
                           std::span<double> acceleration) const noexcept;

  /// Whether a target that starts at rest at its knot 0, which must be in the window, respects the
  /// limits as far as it is known. If `rules.shown` is given, this also limits the peak
  /// acceleration of the first segment in a dimension without an acceleration limit: to the shown
  /// one, or to three times the peak of the segments from kStartFades on (with fewer segments,
  /// three times the acceleration of the first three waypoints) if that is larger.
  [[nodiscard]] bool keeps_start(const SlidingWindow& target, const EntryRules& rules) noexcept;

  /// The end found by the last search. Its spans are valid until the next search.
  [[nodiscard]] const EntryEnd& end() const noexcept { return end_; }

  /// The entry found by the last search.
  [[nodiscard]] const Segment& entry() const noexcept { return entry_; }

 private:
  enum class Verdict { passes, exceeds, untried };

  [[nodiscard]] Outcome search_knots(const SlidingWindow& target, const Instant& from,
                                     const EntryRules& rules, int& tries) noexcept;
  [[nodiscard]] Outcome search_ahead(const SlidingWindow& target, const Instant& from,
                                     const EntryRules& rules, int& tries) noexcept;
  [[nodiscard]] Outcome fall_back(const SlidingWindow& target, const Instant& from,
                                  const EntryRules& rules) noexcept;
  [[nodiscard]] Verdict judge(const Instant& from, const EntryRules& rules, int& tries) noexcept;
  [[nodiscard]] bool keeps_after(const SlidingWindow& target, const EntryRules& rules) noexcept;
  [[nodiscard]] bool rotations_keep_line(const MotionLimits& limits) noexcept;
  [[nodiscard]] bool keeps_ahead(const MotionLimits& limits) noexcept;
  void allow(const Instant& from, const EntryRules& rules) noexcept;
  void write_of_dimensions(const auto& velocity_of, const auto& acceleration_of,
                           const auto& write) const noexcept;
  void allow_positions(const Instant& from, const EntryRules& rules) noexcept;
  void allow_shown(const Instant& from, const EntryRules& rules) noexcept;
  [[nodiscard]] bool leaves_early(const Instant& from) const noexcept;
  [[nodiscard]] bool is_out_of_reach(const Instant& from) const noexcept;
  [[nodiscard]] bool ends_outside(const MotionLimits& limits) const noexcept;
  [[nodiscard]] bool passes(const Instant& from) noexcept;
  [[nodiscard]] bool passes_at_last(const Instant& from, const EntryRules& rules) noexcept;
  [[nodiscard]] std::optional<Time> next_duration(Time from, Time to_newest, bool tries_newest,
                                                  Time shortest) noexcept;

  DimensionKinds kinds_;
  std::size_t next_knot_ = 0;
  std::optional<Time> former_end_;  ///< end of the recomputed entry, if after the newest knot
  double duration_ = 0;             ///< s, of the last end tried after the newest knot; 0: none yet
  bool is_longest_ = false;
  std::optional<std::size_t> fallback_knot_;
  std::optional<std::size_t> last_exceeding_;  ///< last segment of the target that exceeds a limit
  bool knows_after_ = false;
  bool stop_exceeds_ = false;  ///< so does the target's stop, if the rules compare it
  EntryEnd end_;
  State end_state_;
  State rest_;            ///< scratch
  MotionLimits allowed_;  ///< of the current entry
  MotionLimits granted_;  ///< peaks of the recomputed entry, for dimensions without limits
  Segment entry_;
  Segment later_;  ///< scratch
  Extrapolation extrapolation_;
};

}  // namespace splinecast::core
