#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/core/dimension_kind.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/ipc/run_edges.hpp"
#include "splinecast/ipc/segment_board.hpp"

namespace splinecast::ipc {

/// The curve of one stream: the window that is being solved and the board that its segments are
/// published on. Knows neither ring nor clock; what a waypoint must be like is checked before.
///
/// Segments lie on the board under consecutive numbers, run after run: the first segment of a run
/// has the number `Head::run`. A run is entered by cutting the published curve. The board is the
/// only memory of what came before: a solver that takes over, and one that has discarded a
/// revision, both go on from what has been committed.
///
/// Allocates when made only; one thread uses it.
class PublishedCurve {
 public:
  /// Both are sides of one board, and outlive the curve. Throws std::invalid_argument for window
  /// options out of range.
  PublishedCurve(SegmentBoardWriter& board, const SegmentBoardReader& published,
                 const core::WindowOptions& options, core::DimensionKinds kinds);

  /// Whether what was read back from the board was nothing that this class had written: then the
  /// curve is of no more use.
  [[nodiscard]] bool is_damaged() const noexcept { return is_damaged_; }

  /// Goes on from what has been committed, of which `head` is the head. O(K·D).
  void restore(const Head& head) noexcept;

  /// Takes back what has been changed since the last commit; `head` is that commit's.
  void discard(const Head& head) noexcept;

  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return window_; }
  [[nodiscard]] const core::DimensionKinds& kinds() const noexcept { return kinds_; }

  /// The position that the next waypoint is to be near: of the newest waypoint of the run, or of
  /// the state that it was entered from; empty if there is none.
  [[nodiscard]] std::span<const double> newest_position() const noexcept;

  /// Whether anything has been changed since the last commit.
  [[nodiscard]] bool has_changes() const noexcept { return has_changes_; }

  /// Whether there is a curve.
  [[nodiscard]] bool has_begun() const noexcept { return newest_ > 0 || has_changes_; }

  /// The time that the next waypoint must be later than: of the newest knot of the run, or the one
  /// from which the run was entered. There must be a run.
  [[nodiscard]] core::Time newest_time() const noexcept;

  /// The time before which no append changes the run: of the first knot that has not converged.
  [[nodiscard]] core::Time settled_until() const noexcept;

  /// When the curve has come to rest.
  [[nodiscard]] core::Time end_of_motion() const noexcept { return end_; }

  /// Keeps everything up to the right end of the segment that contains t as it has been committed.
  void freeze(core::Time t) noexcept;

  /// Whether the board can take so many more segments without losing one that ends after `keep`;
  /// likewise where the committed curve is cut at t first.
  [[nodiscard]] bool has_room(std::size_t segments, core::Time keep) const noexcept;
  [[nodiscard]] bool has_room_to_enter(core::Time t, std::size_t segments,
                                       core::Time keep) const noexcept;

  /// Begins the curve in a given state, instead of with a waypoint.
  void begin(const core::Instant& state) noexcept;

  /// The first time at which the committed curve can be entered: where it begins; min() if it is
  /// held before, max() if there is none.
  [[nodiscard]] core::Time earliest_entry() const noexcept;

  /// Whether there is a committed curve at t; before the start of a stream that is held there is.
  [[nodiscard]] bool can_enter(core::Time t) const noexcept { return t >= earliest_entry(); }

  /// Cuts the committed curve at t and begins a run that goes on from there. There must be no
  /// uncommitted changes, and a curve at t.
  void enter(core::Time t) noexcept;

  /// Whether acceleration limits allow for the first of these waypoints: see SlidingWindow.
  [[nodiscard]] bool can_append(std::span<const core::Waypoint> waypoints) noexcept {
    return window_.can_append(waypoints);
  }

  /// Appends a waypoint to the run: the ring's item of this number.
  void append(const core::Waypoint& waypoint, Word item) noexcept;

  /// Ends the curve at its newest knot with a condition. If nothing may change that knot any more,
  /// the stop tail runs, and from its end, or from `earliest`, a splice goes back to the waypoint.
  void finish(const core::Condition& end, core::Time earliest) noexcept;

  /// Asks for what an append and a write after it will go through: O(K·D).
  void prefetch() const noexcept;

  /// Writes what has been changed to the board, and to `head` all that it says of the curve.
  void write(Head& head) noexcept;

  /// After the commit.
  void committed() noexcept { has_changes_ = false; }

 private:
  [[nodiscard]] Word number_of(std::size_t segment) const noexcept { return run_ + segment; }
  [[nodiscard]] bool has_room_behind(Word number, std::size_t segments,
                                     core::Time keep) const noexcept;
  [[nodiscard]] Word segment_at(core::Time t) const noexcept;
  [[nodiscard]] core::Knot knot(Word number, Word r, std::span<double> values) noexcept;
  [[nodiscard]] std::span<const core::StandingWaypoint> standing_before(Word number, core::Time t,
                                                                        Word r) noexcept;
  void write_segment(std::size_t i) noexcept;
  void write_besides(const core::Segment& segment) noexcept;
  void note_change(core::Time from) noexcept;
  void restore_run(const Head& head) noexcept;
  void return_to(const core::Knot& knot, core::Time earliest) noexcept;

  SegmentBoardWriter* board_;
  const SegmentBoardReader* published_;
  core::SlidingWindow window_;
  core::DimensionKinds kinds_;
  core::Segment segment_;  ///< scratch
  SegmentCopy copy_;       ///< scratch
  core::State state_;      ///< scratch
  std::vector<core::Knot> knots_;
  std::vector<double> knot_values_;
  StandingWaypoints standing_{};
  std::vector<double> standing_values_;
  std::vector<double> entry_step_;  ///< acceleration step at the left end of the run's splice
  Word run_ = 1;
  Word run_item_ = 0;  ///< item of the run's first waypoint
  Word first_ = 0;
  Word newest_ = 0;
  core::Time end_{};
  core::Time changed_from_ = core::Time::max();
  std::size_t settled_written_ = 0;  ///< leading segments of the run that are on the board for good
  std::size_t besides_ = 0;          ///< segments behind the run's: a return to the last waypoint
  bool has_changes_ = false;
  bool is_damaged_ = false;
};

}  // namespace splinecast::ipc
