#include "ipc/runs/curve_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/forms/instant.hpp"
#include "core/limits/limit_of.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

constexpr std::array<double, kMaxDimensions> kZeros{};

}  // namespace

Word segment_at(const KnotBoardReader& board, const Summary& summary, Time t) noexcept {
  Word low = summary.first;
  Word high = summary.newest;
  while (low < high) {
    const Word middle = high - (high - low) / 2;
    if (board.time_hint(middle) <= t) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

CurveCut::CurveCut(KnotBoardWriter& board, const KnotBoardReader& published, DimensionKinds kinds,
                   MotionLimits limits)
    : board_(&board),
      published_(&published),
      kinds_(std::move(kinds)),
      limits_(std::move(limits)),
      segment_(published.dimensions(), published.smooths()),
      state_(published.dimensions()),
      position_(published.dimensions()) {}

Instant CurveCut::state() const noexcept { return core::instant_of(time_, state_); }

bool CurveCut::read(Word number) noexcept {
  return segment_.take(*published_, summary_, number) == BoardSegment::Taken::whole &&
         is_time_in_range(segment_.left());
}

bool CurveCut::find(const Summary& summary, Time t) noexcept {
  summary_ = summary;
  time_ = t;
  cut_ = segment_at(*published_, summary, t);
  is_held_ = keeps_right_ = false;
  if (!read(cut_)) return false;
  evaluate_at_cut({segment_.left(), segment_.right(), segment_.order(), segment_.coefficients()}, t,
                  state_);
  next_ = cut_;
  ends_ = t >= segment_.right();
  if (cut_ == summary.first && t <= segment_.left()) {  // no segment before it
    cut_ = 0;
    // Copies the bits: before the first knot readers hold this position.
    if (next_ == 1) {
      std::ranges::copy(segment_.coefficients().first(state_.dimensions()),
                        state_.ref().position.begin());
    }
  } else if (t == segment_.left()) {
    // The previous segment keeps the common knot as its right knot, unless it has already been cut.
    const auto before = segment_before(*published_, summary, cut_);
    if (!before || *before == 0 || !read(*before)) return false;
    keeps_right_ = *before + 1 == cut_;
    next_ = keeps_right_ ? cut_ + 1 : cut_;
    cut_ = *before;
  } else if (ends_) {
    is_held_ = t > segment_.right();
    next_ = cut_ + (is_held_ ? 2 : 1);
  } else {
    keeps_right_ = segment_.kind() != SegmentKind::hold;
    next_ = cut_ + (keeps_right_ ? 2 : 1);
  }
  const StateRef state = state_.ref();
  if (next_ > 1) kinds_.normalise_quaternions(state.position, state.velocity, state.acceleration);
  core::clamp_acceleration(limits_, kinds_, state.velocity, state.acceleration);
  return true;
}

std::span<const double> CurveCut::position_at(Time t) noexcept {
  core::evaluate_derivative(segment_.order(), segment_.coefficients(),
                            to_seconds(t - segment_.left()), 0, position_);
  return position_;
}

void CurveCut::write() noexcept {
  if (cut_ == 0) return;
  if (is_held_) {
    write_rest(cut_ + 1, SegmentForm::hold, segment_.right(), position_at(segment_.right()));
  }
  if (ends_) return;  // the cut does not shorten the segment
  if (keeps_right_ && cut_ < summary_.newest) {
    board_->write_form(cut_ + 1, SegmentForm::none, time_);
  } else if (keeps_right_) {
    // The newest segment is a stop: it gets a right knot, which stores where the uncut stop ends.
    const Time end = segment_.natural_right();
    write_rest(cut_ + 1, SegmentForm::none, end, position_at(end), time_);
  }
  board_->write_form(cut_, segment_.left_knot().note.form);
}

void CurveCut::write_rest(Word number, SegmentForm form, Time time,
                          std::span<const double> position, Time begins) noexcept {
  const auto zeros = std::span(kZeros).first(position.size());
  board_->write(number, {.is_new = true,
                         .note = {.form = form},
                         .time = time,
                         .begins = begins,
                         .position = position,
                         .velocity = zeros,
                         .residual = published_->smooths() ? zeros : zeros.first(0)});
}

}  // namespace splinecast::ipc
