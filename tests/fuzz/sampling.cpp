#include "tests/fuzz/sampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace splinecast::fuzz {
namespace {

bool are_numbers(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

Sampling::Sampling(const ipc::KnotBoardReader& board, ipc::Sampler& sampler)
    : board_(&board),
      sampler_(&sampler),
      state_(board.dimensions()),
      snapshot_(board.dimensions()),
      segment_(board.dimensions(), board.smooths()) {}

bool Sampling::find_marks(const ipc::Summary& summary, ipc::Word number, Marks& marks) {
  using Taken = ipc::BoardSegment::Taken;
  if (segment_.take(*board_, summary, number) != Taken::whole) return false;
  const auto used = static_cast<std::size_t>(segment_.order()) * board_->dimensions();
  require(are_numbers(segment_.coefficients().first(used)), "a segment's coefficients are numbers");
  require(segment_.left() <= segment_.right() && segment_.right() <= segment_.natural_right(),
          "a segment does not end before it begins");
  const Time left = segment_.left();
  const Time right = segment_.right();
  marks = {left, right, segment_.natural_right(),
           ipc::to_time(ipc::to_word(left) / 2 + ipc::to_word(right) / 2)};
  return true;
}

void Sampling::tour() {
  constexpr ipc::Word kMost = 24;
  ipc::Summary summary;
  if (board_->copy_summary(board_->look(), summary) && summary.newest > 0) {
    const ipc::Word oldest =
        std::max(summary.first, summary.newest - std::min(summary.newest, kMost));
    for (ipc::Word number = oldest; number <= summary.newest; ++number) {
      Marks marks{};
      if (!find_marks(summary, number, marks)) continue;
      for (const Time t : marks) sample(t, false);
      sample(ipc::to_time(ipc::to_word(marks[0]) - 1), false);
      sample_many(marks, Derivatives::all);
    }
    snapshot(summary.settled_until, summary.newest_time);
  }
  for (const Time t : std::array{Time::min(), Time(0), Time::max()}) {
    sample(t, true);
  }
  snapshot(Time::min(), Time::max());
}

void Sampling::sample(Time t, bool preview) {
  const double untouched = std::numeric_limits<double>::quiet_NaN();
  const StateRef all = state_.ref();
  for (const auto part : {all.position, all.velocity, all.acceleration, all.jerk}) {
    std::ranges::fill(part, untouched);
  }
  const auto status = preview ? sampler_->preview(t, all) : sampler_->sample(t, all);
  require(status < SampleStatus::wrong_dimension, "a sample has a status");
  if (has_values(status)) {
    require(are_numbers(state_.values()), "a status with values has numbers in all dimensions");
  } else {
    require(std::ranges::all_of(state_.values(), [](double value) { return std::isnan(value); }),
            "a status without values does not change the state");
  }
}

void Sampling::sample_many(std::span<const Time> times, Derivatives asked) {
  const std::size_t stride = count(asked) * board_->dimensions();
  values_.assign(times.size() * stride, std::numeric_limits<double>::quiet_NaN());
  statuses_.assign(times.size(), SampleStatus::wrong_dimension);
  const ipc::Word r =
      sampler_->sample_many(times, {.values = values_, .status = statuses_, .derivatives = asked});
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto values = std::span(values_).subspan(i * stride, stride);
    require(statuses_[i] < SampleStatus::wrong_dimension, "each time has a status");
    if (r > 0 && has_values(statuses_[i])) {
      require(are_numbers(values), "a time with values has numbers in all of them");
    } else {
      require(!has_values(statuses_[i]), "without a revision no time has values");
    }
  }
  if (times.empty()) return;
  const SampleBlock too_few{.values = std::span(values_).first(values_.size() - 1),
                            .status = statuses_,
                            .derivatives = asked};
  require(sampler_->sample_many(times, too_few) == 0, "a block of another size gets no values");
}

void Sampling::snapshot(Time from, Time to) {
  const auto status = sampler_->snapshot(from, to, snapshot_);
  if (!has_values(status)) {
    require(snapshot_.segments().empty(), "a snapshot without values has no segments");
    return;
  }
  require(snapshot_.segments().size() <= board_->capacity(), "a snapshot fits the board");
  for (const ipc::SegmentCopy& segment : snapshot_.segments()) {
    const auto used = static_cast<std::size_t>(segment.order) * board_->dimensions();
    require(segment.coefficients.size() >= used, "a segment has coefficients of its order");
    require(are_numbers(std::span(segment.coefficients).first(used)),
            "a snapshot's coefficients are numbers");
    require(are_numbers(segment.acceleration_step), "a snapshot's steps are numbers");
  }
}

Time Sampling::pick(Script& script) {
  Marks marks{};
  ipc::Summary summary;
  if (board_->copy_summary(board_->look(), summary) && summary.newest > 0) {
    (void)find_marks(summary, summary.newest - script.byte() % summary.newest, marks);
  }
  return script.near(marks[script.byte() % marks.size()]);
}

}  // namespace splinecast::fuzz
