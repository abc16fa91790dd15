#pragma once

#include <cstddef>
#include <vector>

#include "core/motion/shown_limits.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {

/// The limits that a published motion shows, for entries of a stream without given limits. A solver
/// that takes over knows earlier runs only from the board, so it may find other limits.
///
/// Allocates only when constructed; one thread uses it.
class ShownMotion : public core::ShownLimits {
 public:
  explicit ShownMotion(const KnotBoardReader& board);

  /// Drops everything, and takes the waypoints that the curve of a summary meets before `end`, as
  /// far as the board holds them. Any process may call it: it skips knots that a writer changes at
  /// the same time. O(kSpan/kStep·(log n + D)).
  void restore(const KnotBoardReader& board, const Summary& summary, Time end) noexcept;

  /// The same for the writer; then also takes the waypoints of the run from number `first` on, from
  /// the passed slots and from the window. O((kSpan/kStep + kPassedSlots)·D).
  void restore(const core::SlidingWindow& window, const KnotBoardReader& board,
               const Summary& summary, Time end, std::size_t first) noexcept;

  /// Whether this has the motion that is on the board: a new stream has none.
  [[nodiscard]] bool is_restored() const noexcept { return is_restored_; }
  void begin_stream() noexcept { is_restored_ = true; }

  /// Keeps a copy. Call before a cut of the curve makes this forget waypoints.
  void begin_cut() noexcept;
  /// The revision with the cut has been committed.
  void committed() noexcept { has_cut_ = false; }
  /// The revision with the cut has been discarded: this is as before the cut.
  void discarded() noexcept;

 private:
  void take_met(const KnotBoardReader& board, const Summary& summary, Time end) noexcept;
  void take_passed(const KnotBoardReader& board, const Summary& summary, std::size_t first,
                   std::size_t end) noexcept;

  bool is_restored_ = false;
  bool has_cut_ = false;          ///< a cut is not committed yet
  core::ShownLimits before_cut_;  ///< this, from before that cut
  std::vector<Word> numbers_;     ///< scratch
  KnotCopy knot_;                 ///< scratch
};

}  // namespace splinecast::ipc
