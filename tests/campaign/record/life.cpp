#include "tests/campaign/record/life.hpp"

#include <algorithm>
#include <chrono>

#include "apps/process/signals.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::campaign::record {
namespace {

using std::chrono::milliseconds;

/// A fast source sends at most this number of waypoints before it pauses.
constexpr std::size_t kMostAtOnce = 4096;

SolverOptions solver_options(const Shape& shape) {
  SolverOptions options;
  if (shape.has_limits) {
    options.limits = MotionLimits{.velocity = {3}, .acceleration = {40}};
    options.beyond = Beyond::refuse;
  }
  return options;
}

ProducerOptions producer_options(const SourcePlan& plan, const Shape& shape) {
  ProducerOptions options{.dimensions = shape.dimensions, .capacity = shape.capacity};
  options.start_tolerance = 1e6;  // the stream before may have ended anywhere
  if (plan.kind == SourceKind::follower) {
    options.clock = StreamClock::law;
    options.law = plan.law;
  } else if (plan.kind != SourceKind::live) {
    options.clock = StreamClock::recorded;
  }
  return options;
}

}  // namespace

Life::Life(const SourcePlan& plan, const Shape& shape, Random& random)
    : plan_(plan),
      shape_(shape),
      random_(random),
      producer_(std::in_place, plan.stream, producer_options(plan, shape)),
      position_(shape.dimensions) {
  interval_ = milliseconds(is_timed() ? 2 + static_cast<std::int64_t>(random.below(20)) : 10);
  begin_solver();
  next_ = first_time();
}

Time Life::first_time() {
  const Time after = producer_->last_time() + interval_;
  return is_timed() ? std::max(after, producer_->now() + milliseconds(100)) : after;
}

void Life::begin_solver() {
  if (plan_.kind == SourceKind::unsolved) return;
  solver_.reset();
  solver_.emplace(plan_.stream, solver_options(shape_));
}

void Life::step() {
  if (!solver_ || (!solver_->attached() && !solver_->attach(clock_))) return;
  while (solver_->step(clock_).consumed > 0) {
  }
}

void Life::run(Time end) {
  while (clock_.now() < end && !apps::stop_requested()) {
    if (is_timed()) {
      send_live();
    } else {
      send_fast();
    }
    if (random_.chance(0.005)) begin_solver();
  }
}

void Life::send_live() {
  if (random_.chance(0.02)) replace();
  if (random_.chance(0.01)) hold_or_release();
  const bool is_starved = random_.chance(0.01);
  append_until(producer_->now() + (is_starved ? Time::zero() : milliseconds(300)));
  step();
  (void)apps::sleep_until(clock_.now() + milliseconds(is_starved ? 400 : 1));
}

/// Fills the ring several times before others can read it.
void Life::send_fast() {
  const std::size_t most = plan_.kind == SourceKind::wide ? 8 * kMostAtOnce : kMostAtOnce;
  const std::size_t count = 1 + random_.below(std::min(4 * shape_.capacity, most));
  for (std::size_t i = 0; i < count; ++i, next_ += interval_) {
    if (append(next_)) continue;
    step();
    if (!append(next_)) break;
  }
  step();
  if (plan_.kind == SourceKind::wide) return;
  (void)apps::sleep_until(clock_.now() + random_.between(milliseconds(1), milliseconds(40)));
}

void Life::append_until(Time end) {
  for (; next_ < end; next_ += interval_) {
    if (append(next_)) continue;
    next_ = std::max(next_, producer_->now() + milliseconds(100));
    return;
  }
}

bool Life::append(Time time) {
  for (std::size_t d = 0; d < position_.size(); ++d) {
    position_[d] = position_at(time, d, false);
  }
  return producer_->append({.time = time, .position = position_}) == AppendStatus::accepted;
}

/// Replaces the future by another motion, or by a stop.
void Life::replace() {
  constexpr std::size_t kCount = 10;
  std::vector<double> values;
  std::vector<Waypoint> waypoints;
  values.reserve(kCount * shape_.dimensions);
  const Time begin = producer_->earliest() + milliseconds(30);
  const bool is_stop = random_.chance(0.3);
  for (std::size_t i = 0; i < kCount && !is_stop; ++i) {
    const Time time = begin + interval_ * static_cast<std::int64_t>(i + 1);
    for (std::size_t d = 0; d < shape_.dimensions; ++d) {
      values.push_back(position_at(time, d, true));
    }
    waypoints.push_back({.time = time, .position = std::span(values).last(shape_.dimensions)});
  }
  const Time at = random_.chance(0.5) ? begin : Time::min();
  if (producer_->replace_from(at, waypoints) != AppendStatus::accepted) return;
  next_ = is_stop ? producer_->now() + milliseconds(600) : waypoints.back().time + interval_;
}

void Life::hold_or_release() {
  if (!stopper_) stopper_.emplace(plan_.stream, "campaign");
  is_stopped_ = !is_stopped_;
  (void)(is_stopped_ ? stopper_->stop() : stopper_->release());
}

void Life::finish() {
  if (stopper_ && is_stopped_) (void)stopper_->release();
  step();
  is_finished_ = producer_->finish() == AppendStatus::accepted;
  step();
}

Sent Life::sent() const {
  Sent sent{.stream = plan_.stream, .id = producer_->stream_id(), .items = producer_->appended()};
  if (!is_finished_ || is_timed() || !solver_ || !solver_->attached()) return sent;
  const auto board = ipc::open_board(plan_.stream, false, {});
  ipc::Summary summary;
  const ipc::KnotBoardReader reader(board.region.bytes(), board.layout);
  const bool is_known = reader.copy_newest_summary(summary) && summary.finished;
  if (is_known && board.header.stream_id == sent.id)
    sent.segments = std::max<ipc::Word>(summary.newest, 2) - 1;
  return sent;
}

}  // namespace splinecast::campaign::record
