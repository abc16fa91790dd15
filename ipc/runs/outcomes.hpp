#pragma once

#include <cstddef>
#include <vector>

#include "ipc/board/outcome_record.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// How far a published curve has come with the waypoints of its run; see the members of Summary.
struct RunProgress {
  Course course{};
  Word knots = 0;
  Word met = 0;
  Word unmet = 0;
  Word goal = 0;  ///< the open entry ends ahead, at the waypoint before this one; 0: at none

  [[nodiscard]] bool is_interpolated() const noexcept {
    return course == Course::on_target || course == Course::entering;
  }
  /// Number of leading waypoints that the curve meets or has passed over.
  [[nodiscard]] Word decided() const noexcept { return is_interpolated() ? knots : unmet; }
};

/// How a finished curve ends.
struct RunEnd {
  EndKind kind{};
  Time rest{};  ///< the curve rests from then on
  Word item = 0;
};

/// Records the outcomes of the items that a solver takes, unless a waypoint is on the spline at its
/// own time: an append stores nothing more than without it. Keeps as many accepted waypoints as the
/// board has knots, at most 16,384; the outcome of an older one that is not final yet is lost.
///
/// A solver that takes over knows no item of its predecessor: the outcomes of these are lost,
/// except those with a record. Allocates only when constructed; one thread uses it.
class Outcomes {
 public:
  /// `board` and `published` are the two sides of one board; both outlive this.
  Outcomes(KnotBoardWriter& board, const KnotBoardReader& published);

  /// Another solver may have written the board until now. Call it after restore().
  void take_over(const Summary& summary) noexcept;

  /// Continues from the last commit, whose summary is `summary`.
  void restore(const Summary& summary) noexcept;

  /// The run has taken a waypoint. O(1).
  void accept(Word item, Time time) noexcept;

  /// Records an outcome of which the solver itself knows.
  void record(const OutcomeRecord& record) noexcept { board_->write_outcome(count_++, record); }

  /// Records that an item is in force at `time`.
  void note_in_force(Word item, OutcomeWay way, Time time) noexcept;

  /// The run has come this far. O(1).
  void advance(const RunProgress& now) noexcept;

  /// The run, which has come this far, is cut at t: what is later is withdrawn, also of the runs
  /// before it. A new run begins. O(waypoints after t, and those that the curve does not meet).
  void cut(const RunProgress& now, Time t) noexcept;

  /// The run ends the curve. Call it after advance() and when its knots are written.
  void end(const RunProgress& now, const RunEnd& how) noexcept;

  /// The curve that ends is at the waypoint `newer` places before the newest one at this time.
  /// Returns false if that is the waypoint's own time, or if the waypoint is not kept.
  bool note_at_end(const RunProgress& now, Word newer, Time time) noexcept;

  /// Sets the summary's part.
  void put(Summary& summary) const noexcept;

 private:
  struct Taken {
    Word item = 0;
    Time time{};
    Word out = kNoItem;  ///< record that says that it is not in force
  };

  /// The waypoint with this index of all accepted ones. Requires that it is kept.
  [[nodiscard]] const Taken& taken(Word index) const noexcept { return taken_[place_of(index)]; }
  [[nodiscard]] std::size_t place_of(Word index) const noexcept {
    return index & (taken_.size() - 1);  // a power of two
  }
  [[nodiscard]] Word oldest_kept() const noexcept;
  [[nodiscard]] Word index_of(const RunProgress& run, Word knot) const noexcept {
    return accepted_ - run.knots + knot;
  }
  void meet(const RunProgress& run, Word knot) noexcept;
  void take_out(Word first, Word end, OutcomeKind kind) noexcept;
  [[nodiscard]] Word end_until(Word first, Word end, Time t) const noexcept;
  void withdraw(Word end, Time t) noexcept;
  void withdraw_recorded(Time t) noexcept;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  std::vector<Taken> taken_;
  Word known_from_ = 0;  ///< waypoints that were accepted before are those of another solver
  Word count_ = 0;       ///< records written
  Word accepted_ = 0;
  Word newest_ = 0;  ///< the most that were ever accepted, also in a discarded revision
  RunProgress run_;
};

}  // namespace splinecast::ipc
