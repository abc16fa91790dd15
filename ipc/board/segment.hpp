#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {

/// Further inputs of a segment, with which it can be solved again.
struct SegmentOrigin {
  std::uint32_t right_newer_knots = 0;  ///< newer knots when its right knot was last solved
  std::optional<Word> item{};           ///< of an entry: item of the run's first waypoint
  bool ends_at_waypoint = false;        ///< whether its right knot is a waypoint's
  Word known = 0;       ///< of an entry ahead: number of waypoints that the run had then
  Word stopped_by = 0;  ///< of a stopper's stop: see stop_item(); else 0
};

/// A copy of a segment of a published curve.
struct SegmentCopy {
  Word number = 0;  ///< of the knot that it begins at
  Word next = 0;    ///< of the segment after it, if there is one
  Time left{};
  Time right{};
  Time natural_right{};  ///< where it would end if it had not been cut
  int order = kCubicOrder;
  SegmentKind kind{};
  std::uint32_t newer_knots = 0;  ///< newer knots when its left knot was last solved
  SegmentOrigin origin{};
  bool has_waypoint = false;                ///< whether its left end is a waypoint
  bool is_corner = false;                   ///< see KnotNote
  std::vector<double> coefficients{};       ///< [power][dimension], `order` powers
  std::vector<double> waypoint{};           ///< position of that waypoint; empty if there is none
  std::vector<double> acceleration_step{};  ///< a⁺ − a⁻ at the left end; empty if the board no
                                            ///< longer has the segment before it
};

/// A reader's own copy of one segment: its knots and the polynomial made from them. Allocates only
/// in its constructor.
///
/// A segment is finite for any bytes on the board: take() refuses one that does not evaluate to
/// finite numbers everywhere between its ends.
class BoardSegment {
 public:
  enum class Taken {
    whole,
    torn,  ///< the writer has advanced, or the data is not what a solver writes
    none,  ///< no segment begins at this knot
  };

  BoardSegment(std::size_t dimensions, bool smooths);

  /// Builds the segment that begins at knot `number`, summary.first to summary.newest, under
  /// summary.revision. Uses the copies of knots in `near`, another segment, if they are still
  /// current. Unless the result is `whole`, this object has no segment afterwards. O(D).
  [[nodiscard]] Taken take(const KnotBoardReader& board, const Summary& summary, Word number,
                           const BoardSegment* near = nullptr) noexcept;

  /// Builds the last segment under summary.revision; the board must have one. Returns whether the
  /// result of take() is `whole`.
  [[nodiscard]] bool take_last(const KnotBoardReader& board, const Summary& summary) noexcept;

  /// Whether the board holds the same segment under summary.revision, which must not be older than
  /// that of this copy: K1, K2.
  [[nodiscard]] bool is_current(const KnotBoardReader& board,
                                const Summary& summary) const noexcept;

  [[nodiscard]] bool is_there() const noexcept { return is_there_; }
  [[nodiscard]] Word number() const noexcept { return left_.number; }
  [[nodiscard]] Word next() const noexcept { return next_; }
  [[nodiscard]] Time left() const noexcept { return segment_.left; }
  [[nodiscard]] Time right() const noexcept { return right_end_; }
  [[nodiscard]] Time natural_right() const noexcept { return segment_.right; }
  [[nodiscard]] int order() const noexcept { return segment_.order; }
  [[nodiscard]] SegmentKind kind() const noexcept { return segment_.kind; }
  /// [power][dimension]; only the first order() powers are valid.
  [[nodiscard]] std::span<const double> coefficients() const noexcept {
    return segment_.coefficients;
  }
  [[nodiscard]] const KnotCopy& left_knot() const noexcept { return left_; }

  /// Whether this is the last segment. is_current() must hold for the same `summary`.
  [[nodiscard]] bool is_last(const Summary& summary) const noexcept;

  /// The revision that last changed this segment. `known` is another copy, of an earlier revision,
  /// or null. If it has a knot with the values of this segment's right knot, then that knot was
  /// written again without a change: the revision that wrote it does not count.
  [[nodiscard]] Word changed_by(const BoardSegment* known = nullptr) const noexcept;

  /// Writes the accelerations at the start and at the end of the segment, D values each.
  void write_accelerations(std::span<double> start, std::span<double> end) const noexcept;

  /// Copies the segment, except the acceleration step. Allocates if `out` must grow.
  void copy_to(SegmentCopy& out) const;

 private:
  [[nodiscard]] static bool fetch(const KnotBoardReader& board, Word number, Word r,
                                  const BoardSegment* near, KnotCopy& out) noexcept;
  [[nodiscard]] bool build(const Summary& summary) noexcept;
  [[nodiscard]] bool build_cubic() noexcept;
  [[nodiscard]] bool arrives_alike(const KnotCopy& knot) const noexcept;

  core::Segment segment_;  ///< with its natural right end
  KnotCopy left_;
  KnotCopy right_;  ///< not copied if no knot follows
  KnotCopy after_;  ///< copied if no segment begins at the right knot
  Time right_end_{};
  Word next_ = 0;
  bool is_there_ = false;
};

/// Finds the segment before the one that begins at knot `number` > summary.first: the nearest
/// earlier knot at which one begins. Returns 0 if there is none on the board, std::nullopt if a
/// knot was written meanwhile.
[[nodiscard]] std::optional<Word> segment_before(const KnotBoardReader& board,
                                                 const Summary& summary, Word number) noexcept;

}  // namespace splinecast::ipc
