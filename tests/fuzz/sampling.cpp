#include "fuzz/sampling.hpp"

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

Sampling::Sampling(const ipc::SegmentBoardReader& board, ipc::Sampler& sampler)
    : board_(&board),
      sampler_(&sampler),
      state_(board.dimensions()),
      snapshot_(board.dimensions()) {}

void Sampling::tour() {
  constexpr ipc::Word kMost = 24;
  ipc::Head head;
  if (board_->copy_head(board_->revision(), head) && head.newest > 0) {
    const ipc::Word oldest = std::max(head.first, head.newest - std::min(head.newest, kMost));
    for (ipc::Word number = oldest; number <= head.newest; ++number) {
      core::Time left{};
      core::Time right{};
      if (!board_->copy_ends(number, head.revision, left, right)) continue;
      const core::Time middle = ipc::to_time(ipc::to_word(left) / 2 + ipc::to_word(right) / 2);
      const core::Time before = ipc::to_time(ipc::to_word(left) - 1);
      for (const core::Time t : std::array{left, middle, right, before}) sample(t, false);
    }
    snapshot(head.settled_until, head.newest_knot);
  }
  for (const core::Time t : std::array{core::Time::min(), core::Time(0), core::Time::max()}) {
    sample(t, true);
  }
  snapshot(core::Time::min(), core::Time::max());
}

void Sampling::sample(core::Time t, bool preview) {
  const double untouched = std::numeric_limits<double>::quiet_NaN();
  const core::StateRef all = state_.ref();
  for (const auto part : {all.position, all.velocity, all.acceleration, all.jerk}) {
    std::ranges::fill(part, untouched);
  }
  const auto status = preview ? sampler_->preview(t, all) : sampler_->sample(t, all);
  require(status < ipc::SampleStatus::wrong_dimension, "a sample has a status");
  if (ipc::has_values(status)) {
    require(are_numbers(state_.values()), "a status with values has numbers in all dimensions");
  } else {
    require(std::ranges::all_of(state_.values(), [](double value) { return std::isnan(value); }),
            "a status without values leaves the state as it was");
  }
}

void Sampling::snapshot(core::Time from, core::Time to) {
  const auto status = sampler_->snapshot(from, to, snapshot_);
  if (!ipc::has_values(status)) {
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

core::Time Sampling::pick(Script& script) {
  core::Time left{};
  core::Time right{};
  ipc::Head head;
  if (board_->copy_head(board_->revision(), head) && head.newest > 0) {
    (void)board_->copy_ends(head.newest - script.byte() % head.newest, head.revision, left, right);
  }
  return script.near(script.byte() % 2 == 0 ? left : right);
}

}  // namespace splinecast::fuzz
