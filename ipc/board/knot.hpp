#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/forms/knot_segment.hpp"
#include "core/solvers/knot_ring.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The properties of a knot other than its values.
struct KnotNote {
  core::SegmentForm form{};     ///< of its segment, which begins here
  bool is_waypoint = false;     ///< whether the knot is a waypoint's
  bool arrives = false;         ///< has the acceleration at which the segment before it ends
  bool starts = false;          ///< has the acceleration at which its own segment begins
  std::uint32_t newer_knots{};  ///< number of newer knots when it was last solved: 0 … 127
  bool is_corner = false;       ///< its segment begins at rest, although the one before it moves;
                                ///< or a stopper's stop begins here
};

/// A knot as a revision writes it. Spans hold one value per dimension.
struct KnotRecord {
  bool is_new = false;  ///< the knot is new in its slot; else only its cell is written
  KnotNote note;
  Time time{};                       ///< of a new knot
  Time begins{};                     ///< when the next segment begins, if none begins here
  std::span<const double> position;  ///< of a new knot: its waypoint; without one, of the curve
  std::span<const double> velocity;
  std::span<const double> acceleration{};  ///< iff note.arrives or note.starts
  std::span<const double> residual{};      ///< iff the board smooths
  Word item = 0;                           ///< the field `item` of kBesideRows
  const core::Prefix* prefix = nullptr;    ///< with `g`: the knot's row; null if unchanged
  std::span<const double> g{};
};

/// A reader's own copy of a knot. Allocates only in its constructor.
class KnotCopy {
 public:
  KnotCopy(std::size_t dimensions, bool smooths)
      : dimensions_(dimensions), smooths_(smooths), values_((smooths ? 4 : 3) * dimensions) {}

  /// Assigns another copy of a knot of the same board: O(D).
  void assign(const KnotCopy& other) noexcept {
    tag = other.tag;
    cell = other.cell;
    slot = other.slot;
    number = other.number;
    time = other.time;
    note = other.note;
    item = other.item;
    const std::size_t used = smooths_ ? 4 : note.arrives || note.starts ? 3 : 2;
    std::memcpy(values_.data(), other.values_.data(), used * dimensions_ * sizeof(double));
  }

  [[nodiscard]] bool is_there() const noexcept { return tag != 0; }
  [[nodiscard]] std::span<const double> waypoint() const noexcept { return values(0); }
  [[nodiscard]] std::span<const double> velocity() const noexcept { return values(1); }
  [[nodiscard]] std::span<const double> acceleration() const noexcept {
    return note.arrives || note.starts ? values(2) : std::span<const double>{};
  }
  [[nodiscard]] std::span<const double> residual() const noexcept {
    return smooths_ ? values(3) : std::span<const double>{};
  }
  [[nodiscard]] core::SegmentEnd end() const noexcept {
    return {time, waypoint(), velocity(), acceleration(), residual()};
  }

  /// Whether a stop that a stopper requested begins here: then `item` says which.
  [[nodiscard]] bool begins_stoppers_stop() const noexcept {
    return note.form == core::SegmentForm::stop && note.is_corner && item > 0;
  }
  /// Whether a run begins here at rest, although the segment before it moves.
  [[nodiscard]] bool begins_at_rest() const noexcept {
    const auto is_zero = [](std::span<const double> values) {
      return std::ranges::all_of(values, [](double value) { return value == 0; });
    };
    return note.is_corner &&
           (!begins_stoppers_stop() || (is_zero(velocity()) && is_zero(acceleration())));
  }

  Word tag = 0;          ///< of the cell that it was copied from; 0: nothing copied
  std::size_t cell = 0;  ///< of its slot, 0 or 1
  std::size_t slot = 0;
  Word number = 0;
  Time time{};
  KnotNote note;
  Word item = 0;  ///< the field `item` of kBesideRows

 private:
  friend class KnotBoardReader;
  [[nodiscard]] std::span<const double> values(std::size_t which) const noexcept {
    return {values_.data() + which * dimensions_, dimensions_};
  }

  std::size_t dimensions_;
  bool smooths_;
  std::vector<double> values_;  ///< waypoint, velocity, acceleration, residual
};

}  // namespace splinecast::ipc
