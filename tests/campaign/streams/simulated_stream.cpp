#include "tests/campaign/streams/simulated_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/fixtures/streams/torn_publication.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::size_t kSettledKept = 48;
/// Largest number of clock readings in one step.
constexpr std::size_t kMostReadings = 4;
/// Largest number of consecutive discarded steps without a delay of the solver.
constexpr int kMostMisses = 20;
/// Longest time that a stream is watched after its producer's end.
constexpr Time kLongestRest = std::chrono::seconds(20);

}  // namespace

SimulatedStream::SimulatedStream(const StreamPlan& plan, StreamFindings& findings, Random& random)
    : plan_(plan),
      findings_(&findings),
      random_(&random),
      now_(plan.begin),
      clock_(now_, [this](Time t) { advance_to(t); }),
      stream_(plan.dimensions.size(), plan.window, plan.ring_capacity, plan.board_capacity,
              plan.ingest, plan.kinds, plan.live),
      check_(plan_, stream_, findings),
      log_(stream_.board.reader),
      producer_(plan_, stream_, check_, findings, random),
      settled_(kSettledKept, plan.dimensions.size()),
      controller_(stream_.board.reader, plan_, log_, findings, random),
      seldom_(stream_.board.reader, plan_, log_, findings, random),
      eager_(stream_.board.reader, plan_, log_, findings, random),
      previewer_(stream_.board.reader, plan_, log_, findings, random),
      next_tick_(now_),
      next_seldom_(now_),
      next_poll_(now_),
      next_step_(now_),
      pace_(random.part(plan.live.settle_ahead, 0.05, 0.5)) {
  stream_.replace_producer();
  stream_.beyond = plan.beyond;
  stream_.replace_solver();
}

bool SimulatedStream::is_over() const {
  if (findings_->stream_failed()) return true;
  const Time end = plan_.begin + plan_.length;
  const bool rests = check_.summary().finished && now_ > check_.end_of_motion();
  return rests || now_ > end + kLongestRest;
}

void SimulatedStream::run() {
  findings_->begin_stream(plan_);
  while (!is_over()) {
    advance_to(next_step_);
    work();
    schedule_solver();
  }
  read_settled_again(stream_.board.reader, plan_, settled_, *findings_);
  if (!findings_->stream_failed()) check_.verify();
  findings_->count_simulated(now_ - plan_.begin);
}

/// Runs everything except the solver until t.
void SimulatedStream::advance_to(Time t) {
  while (!findings_->stream_failed()) {
    const Time next = std::min({producer_.next(), next_tick_, next_seldom_, next_poll_});
    if (next > t) break;
    now_ = std::max(now_, next);
    if (producer_.next() == next) {
      producer_.act(now_);
    } else if (next_tick_ == next) {
      read_now();
    } else if (next_seldom_ == next) {
      read_seldom();
    } else {
      poll();
    }
  }
  now_ = std::max(now_, t);
}

void SimulatedStream::read_now() {
  next_tick_ = now_ + plan_.tick;
  (void)log_.catch_up();
  const bool had_values = controller_.has_read();
  const auto status = controller_.sample(now_, settled_);
  if (had_values && !has_values(status) && status != SampleStatus::busy) {
    findings_->breach(Breach::no_answer,
                      fmt::format("{} at now, {}", to_string(status), now_.count()));
  }
  check_kept_up(status);
}

/// If the solver has been stepped in time, a sample at now has settled or rests.
void SimulatedStream::check_kept_up(SampleStatus status) {
  const bool is_unsettled = status == SampleStatus::provisional || status == SampleStatus::stopping;
  if (!is_unsettled || now_ >= kept_up_until_ || now_ < controller_.settled_until()) return;
  findings_->breach(Breach::unsettled_at_now, fmt::format("{}, settled until {}", now_.count(),
                                                          controller_.settled_until().count()));
}

void SimulatedStream::read_seldom() {
  next_seldom_ = now_ + random_->part(plan_.live.settle_ahead, 20, 120);
  (void)log_.catch_up();
  (void)seldom_.sample(now_, settled_);
}

void SimulatedStream::poll() {
  next_poll_ = now_ + random_->part(plan_.tick, 2, 20);
  (void)log_.catch_up();
  const Time ahead = plan_.live.settle_ahead + plan_.interval * 10;
  const Time t = random_->between(now_ - plan_.live.history - ahead, now_ + ahead);
  (void)previewer_.preview(t, settled_);
  if (random_->chance(0.2)) (void)eager_.sample(random_->between(now_, now_ + ahead), settled_);
  if (random_->chance(0.05)) (void)eager_.preview(t, settled_);
  if (random_->chance(0.003)) {
    read_settled_again(stream_.board.reader, plan_, settled_, *findings_);
  }
}

void SimulatedStream::work() {
  if (findings_->stream_failed()) return;
  if (random_->chance(plan_.step_trouble)) return step_in_trouble();
  if (random_->chance(0.5) && settle_without_step()) return;
  step();
}

/// Raises `settled_until` without a step if there is no other work, as a sweep of many streams
/// does. Returns whether it was raised.
bool SimulatedStream::settle_without_step() {
  const bool has_items = stream_.ring.reader.written() != stream_.solver.seen();
  if (has_items || !stream_.solver.settled_raise().raise(now_)) return false;
  findings_->count(Event::settled_raises);
  check_.look(now_);
  if (was_in_time_) kept_up_until_ = now_ + plan_.live.settle_ahead / 2;
  return true;
}

/// Steps until a step is not discarded. Only the planned faults delay the solver.
void SimulatedStream::step() {
  check_.begin_step();
  for (int tries = 0; tries < kMostMisses; ++tries) {
    const ipc::Word misses = stream_.solver.summary().deadline_misses;
    const ipc::Word late = stream_.solver.summary().late_commits;
    const auto result = stream_.solver.step(clock_);
    check_step(result, misses, late);
    clock_.restart();
    if (!result.missed) return check_.check_stop();
  }
  findings_->breach(Breach::unbounded_step,
                    fmt::format("{} steps discarded at {}", kMostMisses, now_.count()));
}

void SimulatedStream::check_step(const StepResult& result, ipc::Word misses, ipc::Word late) {
  const Time began = clock_.first_reading();
  if (result.damaged) findings_->breach(Breach::board_refused, "damaged in a step");
  if (clock_.readings() > kMostReadings) {
    findings_->breach(Breach::unbounded_step, fmt::format("{} readings", clock_.readings()));
  }
  if (stream_.solver.summary().deadline_misses != misses + (result.missed ? 1 : 0)) {
    findings_->breach(Breach::miscounted, fmt::format("{} misses", misses));
  }
  check_.note_items();
  if (!log_.catch_up()) findings_->breach(Breach::board_refused, "revisions skipped");
  check_.look(began);
  const Time committed = clock_.left_reading(2);
  if (result.published) {
    const bool is_late =
        check_.summary().changed_from < Time::max() && check_.summary().changed_from <= committed;
    if (is_late) findings_->count(Event::late_commits);
    was_in_time_ = committed == began;
    const bool is_counted = stream_.solver.summary().late_commits == late + (is_late ? 1 : 0);
    // A solver that takes over may count a late commit of its predecessor.
    const bool takes_over = std::exchange(has_taken_over_, false);
    if (!takes_over && !is_counted) {
      findings_->breach(Breach::miscounted, fmt::format("{} late commits", late));
    }
  }
  const bool keeps_up = !result.missed && was_in_time_ && check_.summary().newest > 0;
  kept_up_until_ = keeps_up ? began + plan_.live.settle_ahead / 2 : Time::min();
}

/// Injects a fault: a delay between two steps or within one, a death within a step, or a takeover.
void SimulatedStream::step_in_trouble() {
  const Time pause = random_->part(plan_.live.settle_ahead, 0.1,
                                   random_->chance(0.2) ? random_->log_uniform(1, 200) : 3);
  const std::size_t what = random_->below(6);
  if (what <= 1) {
    findings_->count(Event::solver_hold_ups);
    clock_.stop_after_reading(what + 1, pause);
    step();
  } else if (what == 2) {
    findings_->count(Event::solver_hold_ups);
    advance_to(now_ + pause);
    step();
  } else if (what == 3) {
    clock_.stop_after_reading(3, pause);
    step();
  } else if (what == 4) {
    step_and_die();
  } else {
    replace_solver();
    step();
  }
}

/// Dies within a step, with any part of the revision stored. Readers continue meanwhile.
void SimulatedStream::step_and_die() {
  testing::TornPublication torn(stream_.board);
  stream_.clock.time = now_;
  (void)stream_.solver.step(stream_.clock);
  const std::size_t how = random_->below(3);
  if (how == 0) {
    torn.take_back_commit();
  } else if (how == 1) {
    torn.take_back_rest();
    check_.look(now_, false);
  } else {
    const double share = random_->unit();
    torn.take_back([&] { return random_->chance(share); });
  }
  (void)log_.catch_up();
  findings_->count(Event::torn_takeovers);
  kept_up_until_ = Time::min();
  if (random_->chance(0.7)) {
    advance_to(now_ + random_->part(plan_.live.settle_ahead, 0, random_->log_uniform(1, 100)));
  }
  replace_solver();
  step();
}

void SimulatedStream::replace_solver() {
  findings_->count(Event::takeovers);
  has_taken_over_ = true;
  try {
    stream_.replace_solver();
  } catch (const std::exception& error) {
    findings_->breach(Breach::board_refused, error.what());
  }
}

/// Schedules the solver's next step: after its pace, or later if it has no work until then.
void SimulatedStream::schedule_solver() {
  if (random_->chance(0.01)) pace_ = random_->part(plan_.live.settle_ahead, 0.02, 0.6);
  next_step_ = now_ + pace_;
  const bool has_items = stream_.ring.reader.written() != stream_.solver.seen();
  const Time wakes = has_items ? now_ : producer_.next();
  next_step_ = std::max(next_step_, std::min(stream_.solver.due(), wakes));
  next_step_ = std::min(next_step_, now_ + kLongestRest);
}

}  // namespace splinecast::campaign
