#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/limits/position_range.hpp"
#include "core/motion/slowing.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::ipc {

/// The end of a published curve that slows down on its path (see core::Slowing): a knot is searched
/// from which on the curve comes to rest at its last waypoint. The knots from there on keep their
/// numbers and positions; their times, velocities and accelerations change.
///
/// Reads the committed curve from the board. Allocates only when constructed; one thread uses it.
class SlowedEnd {
 public:
  enum class Outcome {
    more,     ///< the search has not ended
    found,    ///< the curve can slow down from knot first() on
    none,     ///< no knot passes
    damaged,  ///< the board holds data that no solver wrote
  };

  /// `published` outlives this.
  SlowedEnd(const KnotBoardReader& published, DimensionKinds kinds);

  /// Begins a search: the curve of this summary is to rest at its newest knot, a waypoint. `limits`
  /// outlive the search.
  void restart(const Summary& summary, const MotionLimits& limits) noexcept;

  /// Tries the knots before the newest one, the latest first, down to knot `oldest`, and none
  /// before the time `settled`. A knot passes if each piece from there on exceeds no limit or bound
  /// that the path keeps, nor one by more than the path; if it stays near the path; and if
  /// quaternions keep their length. Decrements `tries` for each piece, O(D), and returns `more`
  /// when none are left.
  [[nodiscard]] Outcome search(Word oldest, Time settled, int& tries) noexcept;

  /// The knot that was found, its time, and the time of rest.
  [[nodiscard]] Word first() const noexcept { return first_; }
  [[nodiscard]] Time begin() const noexcept { return slowing_.begin(); }
  [[nodiscard]] Time end() const noexcept { return slowing_.end_time(); }

  /// Writes the knots from first() on to the board. Returns false if the committed curve cannot be
  /// read. O(n·D) for n knots.
  [[nodiscard]] bool write(KnotBoardWriter& board) noexcept;

 private:
  /// A knot as it is slowed down. The other values are those of the path.
  struct Knot {
    explicit Knot(const KnotBoardReader& board)
        : path(board.dimensions(), board.smooths()),
          velocity(board.dimensions()),
          acceleration(board.dimensions()) {}

    KnotCopy path;
    Time time{};
    std::vector<double> velocity;
    std::vector<double> acceleration;

    [[nodiscard]] core::SegmentEnd end() const noexcept {
      return {time, path.waypoint(), velocity, acceleration, path.residual()};
    }
  };

  [[nodiscard]] bool begin_at(Word number) noexcept;
  [[nodiscard]] bool slow(Word number, Knot& out) noexcept;
  [[nodiscard]] bool read_path(Word number) noexcept;
  [[nodiscard]] bool build_piece(Word number) noexcept;
  [[nodiscard]] core::SegmentPart path_part() const noexcept;
  [[nodiscard]] bool passes(Word number) noexcept;

  const KnotBoardReader* published_;
  DimensionKinds kinds_;
  Summary summary_;
  const MotionLimits* limits_ = nullptr;
  core::Slowing slowing_{Time::zero(), Time(1)};
  Word first_ = 0;          ///< knot that is tried
  std::size_t passed_ = 0;  ///< number of its pieces that have passed
  bool is_damaged_ = false;
  core::PositionRange range_;  ///< of the path from the knot that is tried
  BoardSegment path_;          ///< scratch
  std::array<Knot, 2> knots_;
  core::Segment piece_;
  std::vector<double> before_;  ///< scratch: acceleration of the path before a knot
  std::vector<double> after_;   ///< scratch: and after it
};

}  // namespace splinecast::ipc
