#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/forms/entry.hpp"
#include "core/limits/check.hpp"
#include "core/online/extrapolation.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

/// What an entry must respect.
struct EntryRules {
  const MotionLimits* limits = nullptr;  ///< given limits
  const MotionLimits* shown = nullptr;  ///< limits shown by the motion: see EntrySearch; null: none
  Time least{};                         ///< shortest duration of an entry
  std::size_t newer = 0;  ///< number of newer knots that must be known if an entry ends at a knot
  bool goes_beyond = false;  ///< the entry may also end after the newest knot
};

/// The end of an entry. Spans refer to memory of the search and are valid until its next call.
struct EntryEnd {
  std::optional<std::size_t> knot{};  ///< knot of the target; none: after the newest one
  std::size_t known = 0;              ///< number of knots that the target had
  Instant state{};
  Time line_end{};  ///< after the newest knot: end of the straight line; at or before the state if
                    ///< that is in the stop segment, or at rest
  Time rest{};      ///< after the newest knot: end of the stop segment
};

/// Number of segments after which the effect of a start at rest on the target has faded to less
/// than a fiftieth.
inline constexpr std::size_t kStartFades = 3;

/// Searches for the entry from a state onto the *target*: the spline through the knots of a run
/// and, after the newest one, its Extrapolation.
///
/// An entry is the quintic from the state to the target's state at its end. Candidates for the end
/// are, in this order, the target's knots that are still in the window, then times after the newest
/// one, each duration kGrowth times the previous one, up to kLongest. The search takes the first
/// candidate for which the quintic and everything after it respect the limits; if there is none,
/// the first for which the quintic itself does.
///
/// The velocity of the newest knot, unless given, is an estimate until the next knot is known. An
/// entry to that knot therefore counts as one that ends after it: the shortest one, onto the
/// beginning of the straight line.
///
/// The velocities and accelerations that a motion has *shown* are estimates; they limit a dimension
/// without an acceleration limit. An entry may always have the values at its two ends, those of a
/// motion over its distance in 1 s, and those of the entry that it replaces. Segments after the
/// entry are not compared with them, and an entry of kLongest may exceed them.
///
/// The search can be interrupted after any candidate; it does not try a rejected one again until
/// `restart`. A candidate that cannot pass, because the mean acceleration or velocity that it needs
/// exceeds its limit, costs O(D) and does not count as tried; there are at most K + 2 knots and 170
/// durations. Only the constructor allocates. Not thread-safe: one thread uses it.
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

  /// The same, to recompute the entry from `from` to `end`, which was after the newest knot. O(D).
  void restart(std::size_t first, const Instant& from, const Instant& end) noexcept;

  /// Tries candidates until one passes, none is left, or `tries` of them have been tried; counts
  /// `tries` down. `from` is the current state, which may be later than in the last call.
  Outcome search(const SlidingWindow& target, const Instant& from, const EntryRules& rules,
                 int& tries) noexcept;

  /// The same for a state at which the curve ends: tries its own time, then later times until one
  /// passes. Call `restart` first.
  Outcome search_rest(const Instant& rest, const Instant& from, const EntryRules& rules,
                      int& tries) noexcept;

  /// Whether a target that starts at rest at its knot 0, which must be in the window, respects the
  /// limits as far as it is known. In a dimension without an acceleration limit, the peak
  /// acceleration of the first segment may be three times that of the segments from kStartFades on,
  /// or, with fewer segments, of the first three waypoints; or the shown one if that is larger.
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
  std::optional<Time> former_end_;  ///< end of the recomputed entry, if after the newest knot
  double duration_ = 0;             ///< s, of the last candidate after the newest knot; 0: none yet
  bool is_longest_ = false;
  std::optional<std::size_t> fallback_knot_;
  std::optional<std::size_t> last_beyond_;  ///< last segment of the target that exceeds a limit
  bool knows_behind_ = false;
  EntryEnd end_;
  State end_state_;
  State rest_;            ///< scratch
  MotionLimits allowed_;  ///< of the current entry
  MotionLimits granted_;  ///< peaks of the recomputed entry, for dimensions without limits
  Segment entry_;
  Segment behind_;  ///< scratch
  Extrapolation extrapolation_;
};

}  // namespace splinecast::core
