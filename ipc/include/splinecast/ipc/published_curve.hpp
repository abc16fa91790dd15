#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "splinecast/core/dimension_kind.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/ipc/board_segment.hpp"
#include "splinecast/ipc/knot_board.hpp"
#include "splinecast/ipc/run_edges.hpp"

namespace splinecast::ipc {

/// The curve of one stream: the window that is being solved and the board that its knots are
/// published on. Knows neither ring nor clock; what a waypoint must be like is checked before.
///
/// Knots lie on the board under consecutive numbers, run after run: `Head::run` is the first knot
/// of a run, its first waypoint or the state that it was entered from. A run is entered by cutting
/// the published curve: the segment that is cut keeps both its knots, and no segment begins at the
/// right one any more. The board is the only memory of what came before: a solver that takes over,
/// and one that has discarded a revision, both go on from what has been committed.
///
/// Allocates when made only; one thread uses it.
class PublishedCurve {
 public:
  /// Both are sides of one board, and outlive the curve. Throws std::invalid_argument for window
  /// options out of range.
  PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                 const core::WindowOptions& options, core::DimensionKinds kinds);

  /// Whether what was read back from the board was nothing that this class had written: then the
  /// curve is of no more use.
  [[nodiscard]] bool is_damaged() const noexcept { return is_damaged_; }

  /// Goes on from what has been committed, of which `head` is the head. O(K·D).
  void restore(const Head& head) noexcept;

  /// Asks for the memory outside this object that the next append goes through. Loads nothing.
  void prefetch() const noexcept;

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

  /// Whether the board can take so many more knots without losing a segment that ends after `keep`;
  /// likewise where the committed curve is cut at t first.
  [[nodiscard]] bool has_room(std::size_t knots, core::Time keep) const noexcept;
  [[nodiscard]] bool has_room_to_enter(core::Time t, std::size_t knots,
                                       core::Time keep) const noexcept;

  /// Begins the curve in a given state, instead of with a waypoint.
  void begin(const core::Instant& state) noexcept;

  /// The first time at which the committed curve can be entered: where it begins; min() if it is
  /// held before, max() if there is none.
  [[nodiscard]] core::Time earliest_entry() const noexcept;

  /// Whether there is a committed curve at t; before the start of a stream that is held there is.
  [[nodiscard]] bool can_enter(core::Time t) const noexcept { return t >= earliest_entry(); }

  /// Finds the state that a run entered at t goes on from, and returns its position. There must be
  /// no uncommitted changes, and a curve at t. Changes nothing.
  std::span<const double> plan_entry(core::Time t) noexcept;

  /// Whether acceleration limits allow for the first of these waypoints to be entered from there.
  [[nodiscard]] bool can_enter_with(std::span<const core::Waypoint> waypoints) noexcept;

  /// Cuts the committed curve there and begins a run that goes on.
  void enter_as_planned() noexcept;

  /// Whether acceleration limits allow for the first of these waypoints: see SlidingWindow.
  [[nodiscard]] bool can_append(std::span<const core::Waypoint> waypoints) noexcept {
    return !trial_ || window_.can_append(waypoints, *trial_);
  }

  /// Appends a waypoint to the run: the ring's item of this number.
  void append(const core::Waypoint& waypoint, Word item) noexcept;

  /// Ends the curve at its newest knot with a condition. If nothing may change that knot any more,
  /// the stop tail runs, and from its end, or from `earliest`, a splice goes back to the waypoint.
  void finish(const core::Condition& end, core::Time earliest) noexcept;

  /// Writes what has been changed to the board, and to `head` all that it says of the curve.
  void write(Head& head) noexcept;

  /// After the commit of that head.
  void committed(const Head& head) noexcept;

 private:
  /// Number of knot i of the run.
  [[nodiscard]] Word number_of(std::size_t knot) const noexcept {
    return run_ + (window_.is_entered() ? 1 : 0) + knot;
  }
  [[nodiscard]] bool has_room_behind(Word number, std::size_t knots,
                                     core::Time keep) const noexcept;
  [[nodiscard]] Word segment_at(core::Time t) const noexcept;
  [[nodiscard]] bool read_knot(Word number, KnotCopy& out) noexcept;
  [[nodiscard]] bool read_segment(Word number) noexcept;
  [[nodiscard]] std::span<const core::StandingWaypoint> standing_before(Word number, bool is_held,
                                                                        core::Time t) noexcept;
  /// What a run is entered behind.
  struct Way {
    core::Time time{};
    Word cut = 0;              ///< segment before the run; 0: nothing stands there
    Word run = 0;              ///< number of the knot that the run begins at
    bool ends = false;         ///< that segment ends at its natural end
    bool is_held = false;      ///< a hold follows it
    bool keeps_right = false;  ///< it keeps its right knot, where no segment begins any more
    std::span<const core::StandingWaypoint> standing{};
  };
  [[nodiscard]] Way way_at(core::Time t) noexcept;
  [[nodiscard]] core::Instant state_on(const Way& way) const noexcept;
  void cut(const Way& way) noexcept;
  /// Whether the run began in a state, and the splice from there may still change.
  [[nodiscard]] bool is_entry_open() const noexcept {
    return window_.is_entered() && kept_ == 0 && open_ == 0;
  }
  void write_given(Word number, core::SegmentForm form, core::Time time,
                   std::span<const double> position, core::Time begins = {}) noexcept;
  void write_entry() noexcept;
  [[nodiscard]] std::size_t plain_knots() const noexcept;
  void write_knots(std::size_t first, std::size_t end) noexcept;
  void write_knot(std::size_t i) noexcept;
  void note_change(core::Time from) noexcept;
  void keep_settled() noexcept;
  void restore_run() noexcept;
  [[nodiscard]] core::Knot restore_knot(Word number, std::span<double> values) noexcept;
  [[nodiscard]] core::SlidingWindow::Entry restore_entry() noexcept;
  void return_to(const core::Knot& knot, core::Time earliest) noexcept;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  core::SlidingWindow window_;
  std::optional<core::SlidingWindow> trial_;  ///< for what the limits ask; none without limits
  core::DimensionKinds kinds_;
  std::size_t look_ahead_;  ///< how many rows before the newest knot an append may change
  bool has_plain_knots_;    ///< the method changes the velocities of knots and no more
  Head head_;               ///< last committed
  core::Segment segment_;   ///< scratch
  BoardSegment read_;       ///< scratch
  KnotCopy knot_;           ///< scratch
  core::State state_;       ///< that a run is entered from
  Way way_;                 ///< as planned
  std::vector<core::Knot> knots_;
  std::vector<double> knot_values_;
  std::vector<double> entry_values_;
  StandingWaypoints standing_{};
  std::vector<double> standing_values_;
  Word run_ = 1;
  Word run_item_ = 0;  ///< item of the run's first waypoint
  Word first_ = 0;
  Word newest_ = 0;
  core::Time end_{};
  core::Time stop_{};  ///< length of the stop, if the newest segment is one
  core::Time changed_from_ = core::Time::max();
  std::size_t committed_knots_ = 0;  ///< knots of the run that the board holds
  std::size_t kept_ = 0;             ///< leading knots of the run that nothing has changed since
  std::size_t open_ = 0;             ///< leading knots of the run that are written for good
  bool is_entry_new_ = false;        ///< the run begins in a state that the board does not hold yet
  std::size_t besides_ = 0;          ///< knots behind the run's: a return to the last waypoint
  bool has_changes_ = false;
  bool is_damaged_ = false;
};

}  // namespace splinecast::ipc
