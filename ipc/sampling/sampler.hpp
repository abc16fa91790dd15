#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/sampling/comparison.hpp"
#include "ipc/sampling/kept_segments.hpp"
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
/// It keeps its own copies of the segments it used last: the knots, with the tags of the revisions
/// that wrote them, and the polynomials made from them. While those tags stand, a sample of one of
/// them copies nothing; where time passes the right knot of the newest one, it copies one knot. One
/// thread uses a sampler; any number of samplers, in any processes, read one board. Stores to
/// shared memory never. Allocates when made only: 16 D doubles, or 19 D of a curve that is
/// smoothed, for each of kSegmentsKept + 1 segments.
class Sampler {
 public:
  /// How many segments it keeps copies of: the horizon of a controller that looks ahead, mostly.
  static constexpr std::size_t kSegmentsKept = KeptSegments::kMost;

  /// How many segments a sample compares at most after missing many revisions.
  static constexpr int kMostCompared = ipc::kMostCompared;

  /// `board` is read as often as sampled; `clock` says whether a hold stands before the first
  /// waypoint; `kinds` are those of the board's dimensions.
  Sampler(const KnotBoardReader& board, StreamClock clock, DimensionKinds kinds = {});
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  Sampler(Sampler&&) noexcept = default;
  Sampler& operator=(Sampler&&) noexcept = default;
  ~Sampler() = default;

  /// Evaluates the curve at `t`, in the form in which its dimensions are read, into `out`, whose
  /// spans have one value per dimension: else it returns `wrong_dimension`. Wait-free: no system
  /// call, no allocation; O(D) where `t` lies in the segment used last or the next one, O(log n +
  /// D) elsewhere; a bounded number of tries. Where the status has no values, `out` is left as it
  /// was.
  ///
  /// On a live stream a sample counts as executed: if a revision since then changed the curve
  /// before the latest time sampled, the next one is `revised`, once. That happens only if the
  /// solver was stopped between its last look at the clock and the commit, or if a time ahead of
  /// what is settled is sampled; use `preview` for that.
  ///
  /// The board keeps which time each of the last kChangesKept revisions changed the curve from.
  /// A reader that has missed more compares the curve itself. Revisions change nothing before the
  /// settled_until that it saw last; where it has sampled from there on, it looks whether the
  /// segments are those of the revision that it saw last, by their tags, or have the bits of its
  /// own copy, and whether a rest continues as a hold. If so, the sample is not `revised`. If they
  /// differ, or cannot be compared because the board no longer keeps them or there are more than
  /// kMostCompared, it is: a change is never missed.
  [[nodiscard]] SampleStatus sample(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus sample(Time t, State& out) noexcept;

  /// The same for a look ahead: what it gives does not count as executed.
  [[nodiscard]] SampleStatus preview(Time t, const StateRef& out) noexcept;

  /// Evaluates the curve at any number of times, increasing or not, all of *one* revision: for
  /// controllers that look ahead, whose horizon must not mix two. Returns that revision, which is
  /// 0 where there was none to be had: then every status says why, and none has values. A look
  /// ahead, which does not count as executed. Wait-free, like `sample`: a bounded number of tries,
  /// each O(N·D) where the times follow each other, and O(N·(log n + D)) at most. A writer that
  /// publishes faster than a try takes leaves `busy`. Where the block's sizes are not those of the
  /// times and of the curve it is `wrong_dimension`.
  Word sample_many(std::span<const Time> times, const SampleBlock& out) noexcept;

  /// The time before which what the last sample saw never changes, whatever its status.
  [[nodiscard]] Time settled_until() const noexcept { return head_.settled_until; }

  /// Copies every segment that has a part between `from` and `to` (inclusive), all under one
  /// revision. Returns `settled` or `provisional` for the whole; `before_history`, `no_data`,
  /// `busy`, `retired` or `wrong_dimension` leave `out` without segments. The segments are the
  /// curve as it was solved, before DimensionKinds::normalise; their acceleration steps are
  /// those of what readers see. The step at the left end of the oldest segment on the board is not
  /// known (empty): begin one segment earlier. Allocates if `out` must grow.
  [[nodiscard]] SampleStatus snapshot(Time from, Time to, BoardSnapshot& out);

  /// The kinds of the board's dimensions.
  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return kinds_; }

  /// The revision that the last sample saw; 0 before the first.
  [[nodiscard]] Word revision_seen() const noexcept { return head_.revision; }

 private:
  /// How often a sample tries again when the writer overtakes it. A try takes well under a
  /// microsecond and fails only if a whole revision was written within it.
  static constexpr int kTries = 16;

  /// Result of looking a time up under one revision.
  enum class Found { segment, before_first, torn };

  [[nodiscard]] bool goes_on(Time t) noexcept;
  [[nodiscard]] Found locate(Time t) noexcept;
  [[nodiscard]] bool spans(const BoardSegment& segment, Time t) const noexcept;
  void read(const BoardSegment& segment, double u, const StateRef& out) const noexcept;
  [[nodiscard]] SampleStatus evaluate(const BoardSegment& segment, Time t,
                                      const StateRef& out) const noexcept;
  [[nodiscard]] SampleStatus execute(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus find(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus look_up(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus hold_first(const StateRef& out) noexcept;
  [[nodiscard]] bool see(const Look& look) noexcept;
  [[nodiscard]] bool fits(const StateRef& out) const noexcept;
  [[nodiscard]] SampleStatus from_own_copy(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus see_newest(Time t) noexcept;
  [[nodiscard]] bool evaluate_many(std::span<const Time> times, const SampleBlock& out) noexcept;
  [[nodiscard]] std::size_t evaluate_moving(std::span<const Time> times, std::size_t first,
                                            std::size_t stride, const SampleBlock& out) noexcept;

  const KnotBoardReader* board_;
  StreamClock clock_;
  DimensionKinds kinds_;
  bool all_linear_;
  Head head_;                         ///< bounds under the revision last seen whole
  Time sampled_until_ = Time::min();  ///< latest time sampled as executed
  bool revised_ = false;              ///< the curve before that time has been changed: not yet told
  KeptSegments kept_;
  State state_;                             ///< scratch
  std::vector<double> start_acceleration_;  ///< scratch
  std::vector<double> end_acceleration_;    ///< scratch
};

}  // namespace splinecast::ipc
