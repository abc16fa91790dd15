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

/// What else a segment came from, for whoever solves it again.
struct SegmentOrigin {
  std::uint32_t right_newer_knots = 0;  ///< that its right knot had seen when it was last solved
  std::optional<Word> item{};           ///< of an entry: the run's first waypoint
  bool ends_at_waypoint = false;        ///< whether its right knot is a waypoint's
  Word known = 0;  ///< of an entry beyond the newest waypoint: how many the run had
};

/// A segment of a published curve, for whoever keeps it.
struct SegmentCopy {
  Word number = 0;  ///< of the knot that it begins at
  Word next = 0;    ///< of the segment behind it, if there is one
  Time left{};
  Time right{};
  Time natural_right{};  ///< where it would end had it not been cut
  int order = kCubicOrder;
  SegmentKind kind{};
  std::uint32_t newer_knots = 0;  ///< that its left knot had seen when it was last solved
  SegmentOrigin origin{};
  bool has_waypoint = false;                ///< whether its left end is a waypoint
  std::vector<double> coefficients{};       ///< [power][dimension], `order` powers
  std::vector<double> waypoint{};           ///< position of that waypoint; empty if there is none
  std::vector<double> acceleration_step{};  ///< a⁺ − a⁻ at the left end; empty where the segment
                                            ///< before it is on the board no more
};

/// A reader's own copy of one segment: the knots that it is made of, and the polynomial made from
/// them. Allocates when made only.
///
/// A segment is finite wherever the board's bytes come from: what does not evaluate to numbers
/// anywhere between its ends is not taken.
class BoardSegment {
 public:
  enum class Taken {
    whole,
    torn,  ///< the writer has gone on, or what lies there is nothing that a solver writes
    none,  ///< no segment begins at this knot
  };

  BoardSegment(std::size_t dimensions, bool smooths);

  /// Makes this the segment that begins at knot `number`, between head.first and head.newest, under
  /// the head's revision. Knots that `near`, another one, has copied and that still stand are taken
  /// from there. Unless it returns `whole`, this is no segment afterwards. O(D).
  [[nodiscard]] Taken take(const KnotBoardReader& board, const Head& head, Word number,
                           const BoardSegment* near = nullptr) noexcept;

  /// Makes this the last segment under the head's revision: there must be one. Returns whether it
  /// is whole.
  [[nodiscard]] bool take_last(const KnotBoardReader& board, const Head& head) noexcept;

  /// Whether it is what the board holds under the head's revision too, which is no older: K1, K2.
  [[nodiscard]] bool is_current(const KnotBoardReader& board, const Head& head) const noexcept;

  [[nodiscard]] bool is_there() const noexcept { return is_there_; }
  [[nodiscard]] Word number() const noexcept { return left_.number; }
  [[nodiscard]] Word next() const noexcept { return next_; }
  [[nodiscard]] Time left() const noexcept { return segment_.left; }
  [[nodiscard]] Time right() const noexcept { return right_end_; }
  [[nodiscard]] Time natural_right() const noexcept { return segment_.right; }
  [[nodiscard]] int order() const noexcept { return segment_.order; }
  [[nodiscard]] SegmentKind kind() const noexcept { return segment_.kind; }
  [[nodiscard]] std::span<const double> coefficients() const noexcept {
    return segment_.coefficients;
  }
  [[nodiscard]] const KnotCopy& left_knot() const noexcept { return left_; }

  /// Whether no segment follows it under a head of which it is current.
  [[nodiscard]] bool is_last(const Head& head) const noexcept;

  /// The revision that last changed it. `known`, another one or null, is of a revision in between:
  /// a right knot that it has copied with the same values was written again, but did not change.
  [[nodiscard]] Word changed_by(const BoardSegment* known = nullptr) const noexcept;

  /// Writes the accelerations with which it starts and ends, D values each.
  void write_accelerations(std::span<double> start, std::span<double> end) const noexcept;

  /// Copies it, all but the acceleration step. Allocates where `out` must grow.
  void copy_to(SegmentCopy& out) const;

 private:
  [[nodiscard]] static bool fetch(const KnotBoardReader& board, Word number, Word r,
                                  const BoardSegment* near, KnotCopy& out) noexcept;
  [[nodiscard]] bool build(const Head& head) noexcept;
  [[nodiscard]] bool build_cubic() noexcept;
  [[nodiscard]] bool arrives_alike(const KnotCopy& knot) const noexcept;

  core::Segment segment_;  ///< with its natural right end
  KnotCopy left_;
  KnotCopy right_;  ///< not copied: none follows
  KnotCopy after_;  ///< where no segment begins at the right knot
  Time right_end_{};
  Word next_ = 0;
  bool is_there_ = false;
};

/// Finds the segment before the one that begins at knot `number` > head.first: the nearest knot
/// before it at which one begins. Returns 0 if there is none on the board, nothing if a knot was
/// written meanwhile.
[[nodiscard]] std::optional<Word> segment_before(const KnotBoardReader& board, const Head& head,
                                                 Word number) noexcept;

}  // namespace splinecast::ipc
