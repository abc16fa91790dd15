#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/forms/way_between.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The position at which the curve of a board rests.
struct CurveEnd {
  std::vector<double> position;  ///< as readers see it; empty: the curve has not begun
  Time rest = Time::min();       ///< from when on, on the stream's clock; min(): it rests already
  bool is_final = false;         ///< the stream is finished
  bool is_own = false;           ///< the board has a curve; else it has the end of the one before
};

/// The end of a board's curve. A board without one has the end of the board that it replaced, if
/// there was one. Allocates. Throws std::bad_alloc only.
[[nodiscard]] CurveEnd end_of_curve(const RegionHeader& header, const KnotBoardReader& board);

/// Whether a stream with this ring's header can start where the one with the board's header rests:
/// both are live and no laws, and have the same dimensions and kinds.
[[nodiscard]] bool may_follow(const RegionHeader& ring, const RegionHeader& board);

/// Where an earlier live stream of the same name has left the machine. Controllers may still hold
/// that position, or someone has moved the machine since: the first waypoint of the new stream is
/// compared with it.
///
/// Allocates when constructed, in look(), and for texts. One thread uses it.
class OldEnd {
 public:
  /// How a curve may begin at a position.
  enum class Way {
    there,      ///< the machine is there
    entry,      ///< from the old end, by an entry that keeps the given limits
    elsewhere,  ///< not without a step
  };

  /// What is known of the old end.
  enum class Known {
    no,       ///< the earlier stream ended without a curve
    not_yet,  ///< a living solver may still take items of the earlier stream
    yes,
  };

  /// The end of the board under a stream's name, if it is that of another live stream with the
  /// dimensions and kinds of `ring`, or keeps such an end. `tolerance` is that of dimensions
  /// without limits. System calls. Throws std::bad_alloc only.
  [[nodiscard]] static std::optional<OldEnd> find(const std::string& stream,
                                                  const RegionHeader& ring, double tolerance,
                                                  const Trust& trust);

  /// Reads the end again, unless it is final. At most a few system calls.
  [[nodiscard]] Known look() noexcept;

  /// The position at which the old curve rests; after move_to() the given one.
  [[nodiscard]] std::span<const double> position() const noexcept { return position_; }

  /// The time from which on the old curve rests, on the clock of the new stream; min(): it rests
  /// already.
  [[nodiscard]] Time rest() const noexcept { return rest_; }

  /// The machine was moved to this position, which has D values.
  void move_to(std::span<const double> position);

  /// How a curve may begin at a position that it must reach within `available`. O(D).
  [[nodiscard]] Way way_to(std::span<const double> position, Time available,
                           const MotionLimits& limits) noexcept;

  /// Whether a position is within the tolerance in each dimension. O(D).
  [[nodiscard]] bool is_near(std::span<const double> position) noexcept;

  /// The limits of the old stream's solver.
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limits_; }

  /// Says how far a position is from this end, and what the producer can do.
  [[nodiscard]] std::string why_elsewhere(std::span<const double> position, Time available,
                                          const MotionLimits& limits);

 private:
  OldEnd(std::string stream, BoardView board, const RegionHeader& ring, double tolerance);

  void take(CurveEnd end);
  [[nodiscard]] bool is_final() const noexcept;
  [[nodiscard]] bool is_reached(std::size_t d, Time available,
                                const MotionLimits& limits) const noexcept;

  std::string stream_;
  BoardView board_;
  DimensionKinds kinds_;
  MotionLimits limits_;
  double tolerance_;
  core::WayBetween way_;  ///< scratch
  std::vector<double> position_;
  bool has_same_clock_;
  Time rest_ = Time::min();
  bool is_final_ = false;
};

}  // namespace splinecast::ipc
