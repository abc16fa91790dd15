#include "ipc/board/segment.hpp"

#include <algorithm>
#include <array>

#include "core/basics/magnitude.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {
namespace {

/// Largest sum of magnitudes of a segment's coefficients: up to this sum, no polynomial of a solver
/// exceeds the range of a double. The sum is smaller for all knots that KnotBoardWriter accepts.
constexpr double kLargestSum = 1e200;

/// Whether the note of a knot has the acceleration that a form needs there.
bool has_start(core::SegmentForm form, const KnotNote& note) noexcept {
  return note.starts || !core::starts_with_acceleration(form);
}
bool has_arrival(core::SegmentForm form, const KnotNote& note) noexcept {
  return note.arrives || !core::arrives_with_acceleration(form);
}

}  // namespace

BoardSegment::BoardSegment(std::size_t dimensions, bool smooths)
    : segment_(dimensions),
      left_(dimensions, smooths),
      right_(dimensions, smooths),
      after_(dimensions, smooths) {}

/// Copies a knot from `near`, if its copy is still current, else from the board.
inline bool BoardSegment::fetch(const KnotBoardReader& board, Word number, Word r,
                                const BoardSegment* near, KnotCopy& out) noexcept {
  if (near != nullptr) {
    // The right knot of `near` first: usually it is the left knot of the next segment, or the right
    // knot of the same segment.
    for (const KnotCopy* const knot : {&near->right_, &near->left_}) {
      if (!board.is_current(*knot, number, r)) continue;
      out.assign(*knot);
      return true;
    }
  }
  return board.copy_knot(number, r, out);
}

BoardSegment::Taken BoardSegment::take(const KnotBoardReader& board, const Summary& summary,
                                       Word number, const BoardSegment* near) noexcept {
  is_there_ = false;
  right_.tag = 0;
  after_.tag = 0;
  const Word r = summary.revision;
  if (!fetch(board, number, r, near, left_)) return Taken::torn;
  if (left_.note.form == core::SegmentForm::none) return Taken::none;
  if (number < summary.newest && !fetch(board, number + 1, r, near, right_)) return Taken::torn;
  const bool is_cut = right_.is_there() && right_.note.form == core::SegmentForm::none &&
                      right_.number < summary.newest;
  if (is_cut && !fetch(board, number + 2, r, near, after_)) return Taken::torn;
  is_there_ = build(summary);
  return is_there_ ? Taken::whole : Taken::torn;
}

bool BoardSegment::take_last(const KnotBoardReader& board, const Summary& summary) noexcept {
  // No segment begins at the last knot of a finished stream.
  Taken taken = take(board, summary, summary.newest);
  if (taken == Taken::none && summary.newest > summary.first)
    taken = take(board, summary, summary.newest - 1);
  return taken == Taken::whole;
}

/// The usual case: a cubic between two waypoints, neither cut nor smoothed.
inline bool BoardSegment::build_cubic() noexcept {
  const Word length = to_word(right_.time) - to_word(left_.time);
  if (right_.time <= left_.time || length > to_word(Time::max())) return false;
  next_ = left_.number + 1;
  right_end_ = right_.time;
  return core::build_cubic({.left = left_.time,
                            .right = right_.time,
                            .left_position = left_.waypoint().data(),
                            .right_position = right_.waypoint().data(),
                            .left_velocity = left_.velocity().data(),
                            .right_velocity = right_.velocity().data()},
                           segment_) <= kLargestSum;
}

bool BoardSegment::build(const Summary& summary) noexcept {
  using core::SegmentForm;
  const SegmentForm form = left_.note.form;
  const bool is_plain = right_.is_there() && !after_.is_there() && left_.residual().empty();
  if (form == SegmentForm::cubic && is_plain) return build_cubic();
  if (!has_start(form, left_.note)) return false;
  core::SegmentEnd right = right_.end();
  next_ = left_.number + 1;
  if (!right_.is_there()) {
    if (form != SegmentForm::stop && form != SegmentForm::hold) return false;
    right.time = left_.time + (form == SegmentForm::stop ? summary.stop : Time::zero());
  } else if (!has_arrival(form, right_.note)) {
    return false;
  }
  const bool may_be_empty = form == SegmentForm::hold;
  if (may_be_empty ? right.time < left_.time : right.time <= left_.time) return false;
  // Its length must fit into a Time.
  if (to_word(right.time) - to_word(left_.time) > to_word(Time::max())) return false;
  right_end_ = right.time;
  if (after_.is_there()) {
    next_ = after_.number;
    right_end_ = after_.time;
    if (after_.note.form == SegmentForm::none || right_end_ < left_.time ||
        right_end_ > right.time) {
      return false;
    }
  }
  core::build_segment(form, left_.end(), right, segment_);
  const std::size_t values =
      static_cast<std::size_t>(segment_.order) * segment_.acceleration_step.size();
  return core::magnitude_of(std::span(segment_.coefficients).first(values)) <= kLargestSum;
}

bool BoardSegment::is_current(const KnotBoardReader& board, const Summary& summary) const noexcept {
  const Word r = summary.revision;
  const Word last = after_.is_there()   ? after_.number
                    : right_.is_there() ? right_.number
                                        : number();
  return is_there_ && number() >= summary.first && last <= summary.newest &&
         board.is_current(left_, r) && (!right_.is_there() || board.is_current(right_, r)) &&
         (!after_.is_there() || board.is_current(after_, r));
}

bool BoardSegment::is_last(const Summary& summary) const noexcept {
  if (!right_.is_there()) return number() == summary.newest;
  return right_.number == summary.newest && right_.note.form == core::SegmentForm::none;
}

/// Whether this segment would end in the same way with `knot` as its right knot: the same number,
/// time and values.
bool BoardSegment::arrives_alike(const KnotCopy& knot) const noexcept {
  const bool arrives = core::arrives_with_acceleration(left_.note.form);
  return knot.is_there() && knot.number == right_.number && knot.time == right_.time &&
         std::ranges::equal(knot.waypoint(), right_.waypoint()) &&
         std::ranges::equal(knot.velocity(), right_.velocity()) &&
         std::ranges::equal(knot.residual(), right_.residual()) &&
         (!arrives || std::ranges::equal(knot.acceleration(), right_.acceleration()));
}

Word BoardSegment::changed_by(const BoardSegment* known) const noexcept {
  // A stop or a hold has no other input than its left knot and its end. If only its end changes,
  // the solver writes the left knot again.
  const core::SegmentForm form = left_.note.form;
  const bool has_one = form == core::SegmentForm::stop || form == core::SegmentForm::hold;
  const Word left = revision_of(left_.tag);
  const bool is_known =
      known != nullptr && (arrives_alike(known->left_) || arrives_alike(known->right_));
  return has_one || is_known ? left : std::max(left, revision_of(right_.tag));
}

void BoardSegment::write_accelerations(std::span<double> start,
                                       std::span<double> end) const noexcept {
  core::SegmentEnd right = right_.end();
  right.time = segment_.right;
  core::write_end_accelerations(left_.note.form, left_.end(), right, start, end);
  if (right_end_ == segment_.right) return;
  core::evaluate_derivative(segment_.order, segment_.coefficients,
                            to_seconds(right_end_ - segment_.left), 2, end);
}

void BoardSegment::copy_to(SegmentCopy& out) const {
  const std::size_t dimensions = segment_.acceleration_step.size();
  out.number = number();
  out.next = next_;
  out.left = segment_.left;
  out.right = right_end_;
  out.natural_right = segment_.right;
  out.order = segment_.order;
  out.kind = segment_.kind;
  out.newer_knots = left_.note.newer_knots;
  out.origin = {};
  if (right_.is_there()) {
    out.origin.right_newer_knots = right_.note.newer_knots;
    out.origin.ends_at_waypoint = right_.note.is_waypoint;
  }
  if (left_.note.form == core::SegmentForm::entry && left_.item > 0) {
    out.origin.item = left_.item - 1;
    if (!right_.note.is_waypoint) out.origin.known = right_.item;
  }
  out.has_waypoint = left_.note.is_waypoint;
  if (left_.begins_stoppers_stop()) out.origin.stopped_by = left_.item;
  out.is_corner = left_.begins_at_rest();
  const auto coefficients =
      std::span(segment_.coefficients).first(static_cast<std::size_t>(segment_.order) * dimensions);
  out.coefficients.assign(coefficients.begin(), coefficients.end());
  const auto waypoint = left_.waypoint().first(out.has_waypoint ? dimensions : 0);
  out.waypoint.assign(waypoint.begin(), waypoint.end());
}

std::optional<Word> segment_before(const KnotBoardReader& board, const Summary& summary,
                                   Word number) noexcept {
  // Between two knots at which segments begin there is at most one at which none does.
  constexpr Word kLookBack = 2;
  for (Word back = 1; back <= kLookBack && number >= summary.first + back; ++back) {
    Time time{};
    core::SegmentForm form{};
    if (!board.copy_time(number - back, summary.revision, time, form)) return std::nullopt;
    if (form != core::SegmentForm::none) return number - back;
  }
  return 0;
}

}  // namespace splinecast::ipc
