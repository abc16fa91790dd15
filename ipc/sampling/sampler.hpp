#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/sampling/comparison.hpp"
#include "ipc/sampling/kept_segments.hpp"
#include "ipc/sampling/seconds.hpp"
#include "ipc/sampling/snapshot.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The reader without its region: looks a time up on a knot board and evaluates the curve.
///
/// Keeps its own copies of the segments it used last: the knots, with the tags of the revisions
/// that wrote them, and the polynomials made from them. While those tags are unchanged, a sample of
/// a kept segment copies nothing. A sample of the segment after the newest kept one copies one
/// knot. One thread uses a sampler; any number of samplers, in any processes, read one board. Never
/// stores to shared memory. Allocates only when constructed: 16 D doubles, or 19 D of a curve that
/// is smoothed, for each of kSegmentsKept + 1 segments.
class Sampler {
 public:
  /// Number of segments of which it keeps copies: usually the horizon of a controller that looks
  /// ahead.
  static constexpr std::size_t kSegmentsKept = KeptSegments::kMost;

  /// Maximum number of segments that a sample compares after missing many revisions.
  static constexpr int kMostCompared = ipc::kMostCompared;

  /// Each sample reads `board`; `clock` decides whether a hold precedes the first waypoint; `kinds`
  /// are those of the board's dimensions.
  Sampler(const KnotBoardReader& board, StreamClock clock, DimensionKinds kinds = {});
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  Sampler(Sampler&&) noexcept = default;
  Sampler& operator=(Sampler&&) noexcept = default;
  ~Sampler() = default;

  /// Evaluates the curve at `t` into `out`, with normalised values. Each span of `out` has one
  /// value per dimension: else returns `wrong_dimension`. Wait-free: no system call, no allocation,
  /// a bounded number of tries; O(D) if `t` is in the segment used last or the next one, else O(log
  /// n + D). Leaves `out` unchanged if the status has no values.
  ///
  /// On a live stream a sample counts as executed: if a later revision changes the curve before the
  /// latest time sampled, the next sample is `revised`, once. That happens only if the solver was
  /// stopped between its last clock reading and the commit, or if a time that has not settled is
  /// sampled; use `preview` for that.
  ///
  /// For each of the last kChangesKept revisions the board keeps the time from which it changed the
  /// curve. A reader that has missed more compares the curve itself. Revisions change nothing
  /// before the settled_until that the reader saw last; from there to the latest time sampled, it
  /// compares the segments with those of the revision that it saw last, by their tags or by the
  /// bits of its own copy. A hold in the same position that now follows the end of that curve is
  /// equal. If the segments are equal, the sample is not `revised`. If they differ, or cannot be
  /// compared because the board no longer keeps them or there are more than kMostCompared, the
  /// sample is `revised`: a change is never missed.
  [[nodiscard]] SampleStatus sample(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus sample(Time t, State& out) noexcept;

  /// The same as sample(), but the sample does not count as executed: for times ahead.
  [[nodiscard]] SampleStatus preview(Time t, const StateRef& out) noexcept;

  /// The same two, at `fraction` seconds after t, 0 to 1e-9: for a time that follows from a law.
  [[nodiscard]] SampleStatus sample(Time t, double fraction, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus preview(Time t, double fraction, const StateRef& out) noexcept;

  /// The polynomial of a time, and the time within it.
  struct Place {
    int order = 0;
    std::span<const double> coefficients;
    double u = 0;  ///< seconds after the polynomial's left end
    SampleStatus status{};
  };

  /// Finds the polynomial that sample() or preview() at t would evaluate, if it is the one used
  /// last and nothing has been published since. Returns false if it is not known so easily: then
  /// sample. O(1), without a call.
  [[nodiscard]] bool find_current(Time t, bool is_executed, Place& out) noexcept;

  /// Whether each span has one value per dimension.
  [[nodiscard]] bool fits(const StateRef& out) const noexcept {
    const std::size_t wanted = board_->dimensions();
    return ((out.position.size() ^ wanted) | (out.velocity.size() ^ wanted) |
            (out.acceleration.size() ^ wanted) | (out.jerk.size() ^ wanted)) == 0;
  }

  /// Whether samples are the values of the polynomials: no dimension is periodic or a quaternion.
  [[nodiscard]] bool all_linear() const noexcept { return all_linear_; }

  /// From now on a retired board is sampled like any other.
  void follow_retired() noexcept { follows_retired_ = true; }

  /// Evaluates the curve at any number of times, in any order, all of *one* revision, for
  /// controllers that look ahead. Returns that revision, or 0 if none could be read: then every
  /// status gives the reason, and none has values. Does not count as executed. Wait-free, like
  /// `sample`: a bounded number of tries, each O(N·D) for consecutive times and O(N·(log n + D)) at
  /// most. The status is `busy` if the writer publishes faster than a try takes, and
  /// `wrong_dimension` if the sizes of the block do not match the times and the curve.
  Word sample_many(std::span<const Time> times, const SampleBlock& out) noexcept;

  /// The curve that the last sample saw never changes before this time. Valid for any status of
  /// that sample.
  [[nodiscard]] Time settled_until() const noexcept { return summary_.settled_until; }

  /// Copies every segment that has a part between `from` and `to` (inclusive), all under one
  /// revision. Returns `settled` or `provisional` for the whole; `before_history`, `no_data`,
  /// `busy`, `retired` or `wrong_dimension` leave `out` without segments. The segments are the
  /// curve as it was solved, before DimensionKinds::normalise; their acceleration steps are
  /// normalised. The step at the left end of the oldest segment on the board is not known (empty):
  /// begin one segment earlier. Allocates if `out` must grow.
  [[nodiscard]] SampleStatus snapshot(Time from, Time to, BoardSnapshot& out);

  /// The kinds of the board's dimensions.
  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return kinds_; }

  /// The revision that the last sample saw; 0 before the first.
  [[nodiscard]] Word revision_seen() const noexcept { return summary_.revision; }

 private:
  /// Maximum number of tries of a sample when the writer overtakes it. A try takes well under a
  /// microsecond and fails only if a whole revision was written within it.
  static constexpr int kTries = 16;

  /// Result of looking a time up under one revision.
  enum class Found { segment, before_first, torn };

  [[nodiscard]] bool is_gone() const noexcept { return board_->retired() && !follows_retired_; }
  [[nodiscard]] bool continues(Time t) noexcept;
  [[nodiscard]] Found locate(Time t) noexcept;
  [[nodiscard]] bool spans(const BoardSegment& segment, Time t) const noexcept;
  [[nodiscard]] SampleStatus evaluate(const BoardSegment& segment, Time t,
                                      const StateRef& out) const noexcept;
  [[nodiscard]] SampleStatus execute(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus find(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus look_up(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus hold_first(const StateRef& out) noexcept;
  [[nodiscard]] bool see(const Look& look) noexcept;
  [[nodiscard]] SampleStatus from_own_copy(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus see_newest(Time t) noexcept;
  [[nodiscard]] bool evaluate_many(std::span<const Time> times, const SampleBlock& out) noexcept;
  [[nodiscard]] std::size_t evaluate_moving(std::span<const Time> times, std::size_t first,
                                            std::size_t stride, const SampleBlock& out) noexcept;

  const KnotBoardReader* board_;
  StreamClock clock_;
  DimensionKinds kinds_;
  bool all_linear_;
  bool follows_retired_ = false;
  double fraction_ = 0;               ///< s, of the time that is sampled
  Summary summary_;                   ///< bounds of the last revision that was copied completely
  Time sampled_until_ = Time::min();  ///< latest time sampled as executed
  bool revised_ = false;              ///< the curve before that time has changed: not yet reported
  KeptSegments kept_;
  State state_;                             ///< scratch
  std::vector<double> start_acceleration_;  ///< scratch
  std::vector<double> end_acceleration_;    ///< scratch
};

inline bool Sampler::find_current(Time t, bool is_executed, Place& out) noexcept {
  const Look look = board_->look();
  const KeptSegments::CurrentInterval& interval = kept_.current_interval();
  const bool is_known = look.revision == kept_.confirmed_by() && t >= interval.left &&
                        t < interval.right && !revised_ && !is_gone();
  if (!is_known) return false;
  summary_.settled_until = look.settled_until;
  kept_.see_settled(look.settled_until);
  if (is_executed) sampled_until_ = std::max(sampled_until_, t);
  const BoardSegment& own = kept_.current();
  const bool is_settled = interval.is_finished || t < look.settled_until;
  out = {.order = own.order(),
         .coefficients = own.coefficients(),
         .u = seconds_after(interval.left, t),
         .status = is_settled ? SampleStatus::settled : SampleStatus::provisional};
  return true;
}

/// Copies the requested derivatives of a state, in sequence: count(asked)·D values.
void copy_derivatives(const State& state, Derivatives asked, std::span<double> out) noexcept;

}  // namespace splinecast::ipc
