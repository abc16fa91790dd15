#include "tests/campaign/streams/simulated_producer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <utility>

namespace splinecast::campaign {
namespace {

/// Probabilities of a producer's actions.
constexpr double kReplaces = 0.04;
constexpr double kStops = 0.01;
constexpr double kMistakes = 0.02;
constexpr double kDies = 0.01;
constexpr double kSkipsWhatIsPast = 0.85;
constexpr double kKnowsLess = 0.1;
constexpr double kSendsAgain = 0.4;
constexpr double kBlends = 0.4;
/// Largest number of waypoints sent in one action.
constexpr int kMostAtOnce = 300;
constexpr std::size_t kMostReplaced = 40;

}  // namespace

SimulatedProducer::SimulatedProducer(const StreamPlan& plan, testing::MemoryStream& stream,
                                     RevisionCheck& check, StreamFindings& findings, Random& random)
    : plan_(&plan),
      stream_(&stream),
      check_(&check),
      findings_(&findings),
      random_(&random),
      blends_(plan.seed + 1),
      source_(plan, random),
      observed_(plan.dimensions.size()),
      phase_end_(plan.begin),
      next_(plan.begin + random.part(plan.live.settle_ahead, 0, 3)),
      next_waypoint_(plan.begin) {}

ipc::WaypointRingWriter::Solved SimulatedProducer::solved() {
  const bool knows = check_->summary().newest > 0 && !random_->chance(kKnowsLess);
  return {.consumed = stream_->board.reader.consumed(),
          .settled_until = knows ? check_->summary().settled_until : Time::min(),
          .refused_until = knows ? check_->summary().refused_until : Time::max()};
}

AppendStatus SimulatedProducer::answered(AppendStatus status) {
  findings_->count(status);
  check_->note_items();
  return status;
}

void SimulatedProducer::act(Time now) {
  if (has_finished()) {
    next_ = Time::max();
    return;
  }
  if (!has_started_) start(now);
  if (now >= plan_->begin + plan_->length) return finish(now);
  if (now >= phase_end_) change_phase(now);
  if (random_->chance(kReplaces + kStops + kMistakes + kDies)) do_something_else(now);
  send_due(now);
  observe();
}

void SimulatedProducer::start(Time now) {
  has_started_ = true;
  lead_ = plan_->live.settle_ahead + plan_->live.least_entry + plan_->interval;
  next_waypoint_ = now + lead_;
  if (!plan_->starts_in_motion) return;
  const Waypoint state = source_.smooth_at(now + lead_);
  const auto status = answered(stream_->ring.writer.start_from(
      {state.time, state.position, state.velocity, state.acceleration}, solved()));
  if (status == AppendStatus::accepted) findings_->count(Event::starts_in_motion);
  next_waypoint_ += lead_ / 2 + plan_->interval;
}

void SimulatedProducer::change_phase(Time now) {
  constexpr std::array kPhases{Phase::steady, Phase::steady, Phase::jittered, Phase::jittered,
                               Phase::late,   Phase::silent, Phase::burst};
  phase_ = kPhases[random_->below(kPhases.size())];
  phase_end_ = now + random_->part(plan_->interval, 3, 60);
  source_.change_mode();
  const Time enough = plan_->live.settle_ahead + plan_->live.least_entry;
  switch (phase_) {
    case Phase::late:
      lead_ = random_->part(enough, -0.2, 1.2);
      break;
    case Phase::burst:
      lead_ = enough + random_->part(plan_->interval, 30, 400);
      break;
    case Phase::silent:
      phase_end_ = now + lead_ + random_->part(plan_->live.settle_ahead, 0, 200);
      lead_ = enough + plan_->window.stop_length;
      break;
    default:
      lead_ = enough + random_->part(plan_->interval, 0.2, 25);
  }
}

void SimulatedProducer::send_due(Time now) {
  if (phase_ == Phase::silent) {
    next_ = phase_end_;
    return;
  }
  const Time earliest = now + plan_->live.settle_ahead;
  if (next_waypoint_ < earliest && random_->chance(kSkipsWhatIsPast)) {
    next_waypoint_ = std::max(next_waypoint_, now + std::max(lead_, plan_->live.settle_ahead));
  }
  is_full_ = false;
  for (int sent = 0; sent < kMostAtOnce && !is_full_ && next_waypoint_ - lead_ <= now; ++sent) {
    send_next();
  }
  next_ = std::max(next_waypoint_ - lead_, now + random_->part(plan_->interval, 0.02, 0.5));
  if (is_full_) next_ = now + random_->part(plan_->interval, 0.5, 5);
  next_ = std::max(next_, now + Time(1000));
}

void SimulatedProducer::send_next() {
  const bool has_jitter = phase_ == Phase::jittered;
  const Time t =
      next_waypoint_ + (has_jitter ? random_->part(plan_->interval, -0.45, 0.45) : Time(0));
  const auto status = answered(stream_->ring.writer.append(source_.at(t), solved()));
  is_full_ = status == AppendStatus::full;
  if (status == AppendStatus::accepted) last_sent_ = t;
  if (!is_full_) next_waypoint_ += plan_->interval;
}

void SimulatedProducer::do_something_else(Time now) {
  const double what = random_->uniform(0, kReplaces + kStops + kMistakes + kDies);
  if (what < kReplaces) {
    const std::size_t times = random_->chance(0.3) ? 2 + random_->below(3) : 1;
    for (std::size_t i = 0; i < times; ++i) replace(now);
    if (times > 1 && random_->chance(0.5)) stop(now);
  } else if (what < kReplaces + kStops) {
    stop(now);
  } else if (what < kReplaces + kStops + kMistakes) {
    make_mistake(now);
  } else {
    die(now);
  }
}

/// A time as early as possible, within the sent waypoints, far ahead, or too late.
Time SimulatedProducer::replacement_time(Time now) {
  const Time settled = std::max(check_->summary().settled_until, now);
  const Time last = stream_->ring.writer.last_time();
  switch (random_->below(5)) {
    case 0:
      return settled;
    case 1:
      return settled + random_->part(plan_->live.settle_ahead, 0, 3);
    case 2:
      return last > settled ? random_->between(settled, last) : settled + plan_->interval;
    case 3:
      return std::max(last, settled) + random_->part(plan_->interval, 0, 20);
    default:
      return settled - random_->part(plan_->live.settle_ahead, 0, 3);
  }
}

void SimulatedProducer::replace(Time now) {
  const Time t = replacement_time(now);
  const std::size_t most = std::min(kMostReplaced, plan_->ring_capacity - 1);
  const std::size_t count = random_->below(most + 1);
  std::vector<std::vector<double>> values;
  std::vector<Waypoint> waypoints;
  const auto keep = [&values](std::span<const double> from) {
    values.emplace_back(from.begin(), from.end());
    return std::span<const double>(values.back());
  };
  values.reserve(3 * count);
  Time at = t + random_->part(plan_->live.least_entry, 0.5, 4);
  for (std::size_t i = 0; i < count; ++i) {
    at += random_->part(plan_->interval, 0.5, 1.5);
    const Waypoint waypoint = source_.at(at);
    waypoints.push_back({.time = at,
                         .position = keep(waypoint.position),
                         .velocity = keep(waypoint.velocity),
                         .acceleration = keep(waypoint.acceleration)});
  }
  const Time blend = blends_.chance(kBlends) ? blends_.part(plan_->interval, 0, 40) : Time(0);
  const auto status = answered(stream_->ring.writer.replace_from(t, waypoints, solved(), blend));
  if (status != AppendStatus::accepted) return;
  if (blend > Time(0)) findings_->count(Event::blends);
  const Time last = std::exchange(last_sent_, at);
  next_waypoint_ = (count == 0 ? t : at) + plan_->interval;
  // Continues the old plan, like a producer that considers the replacement refused.
  if (last > at && random_->chance(kSendsAgain)) next_waypoint_ = last;
  if (count == 0) check_->expect_stop(stream_->ring.writer.written() - 1, t);
}

void SimulatedProducer::stop(Time now) {
  const Time t = replacement_time(now);
  if (answered(stream_->ring.writer.replace_from(t, {}, solved())) != AppendStatus::accepted)
    return;
  check_->expect_stop(stream_->ring.writer.written() - 1, t);
  next_waypoint_ = t + plan_->interval;
  if (random_->chance(0.5)) return;
  phase_ = Phase::silent;
  phase_end_ = now + random_->part(plan_->window.stop_length, 0, 2);
}

/// Makes a call that is refused.
void SimulatedProducer::make_mistake(Time now) {
  auto& writer = stream_->ring.writer;
  Waypoint waypoint = source_.at(next_waypoint_);
  std::vector<double> position(waypoint.position.begin(), waypoint.position.end());
  switch (random_->below(7)) {
    case 0:
      position[0] = std::numeric_limits<double>::quiet_NaN();
      break;
    case 1:
      position.push_back(0);
      break;
    case 2:
      waypoint.time = writer.last_time();
      break;
    case 3:
      waypoint.time = writer.last_time() - plan_->interval;
      break;
    case 4:
      waypoint.time = writer.last_time() + Time(10);
      break;
    case 5:
      waypoint.time = writer.last_time() + std::chrono::hours(2);
      break;
    default:
      return replace_too_many(now);
  }
  waypoint.position = position;
  auto known = solved();
  testing::FixedClock clock;
  clock.time = now;
  if (waypoint.time.count() % 2 == 0) {
    known.clock = &clock;
    known.horizon = std::chrono::hours(1);
  }
  (void)answered(writer.append(waypoint, known));
}

void SimulatedProducer::replace_too_many(Time now) {
  const std::vector<Waypoint> waypoints(plan_->ring_capacity);
  const Time later = std::max(now, check_->summary().settled_until) + plan_->interval;
  (void)answered(stream_->ring.writer.replace_from(later, waypoints, solved()));
  const Waypoint state = source_.smooth_at(now);
  (void)answered(stream_->ring.writer.start_from(
      {state.time, state.position, state.velocity, state.acceleration}, solved()));
}

/// Dies between two calls, or within one before it stores `summary`. A new producer takes over.
void SimulatedProducer::die(Time now) {
  if (random_->chance(0.5)) {
    const auto words = ipc::words_at(stream_->ring.bytes.span(), 0,
                                     stream_->ring.layout.bytes / sizeof(ipc::Word));
    ipc::Word& summary = words[stream_->ring.layout.control / sizeof(ipc::Word) + ipc::kWritten];
    const ipc::Word before = summary;
    const Time t = std::max(now, check_->summary().settled_until) + plan_->interval;
    const std::array waypoints{source_.at(t + plan_->interval)};
    (void)stream_->ring.writer.replace_from(t, waypoints, solved());
    summary = before;
    findings_->count(Event::torn_appends);
  }
  stream_->replace_producer();
  findings_->count(Event::producer_continuations);
}

void SimulatedProducer::finish(Time now) {
  if (answered(stream_->ring.writer.finish(plan_->end, solved())) == AppendStatus::accepted) {
    (void)answered(stream_->ring.writer.append(source_.at(next_waypoint_), solved()));
    next_ = Time::max();
  } else {
    next_ = now + random_->part(plan_->interval, 0.2, 2);
  }
}

/// Reads an item of the ring like a passive observer.
void SimulatedProducer::observe() {
  const ipc::SentItems& items = check_->items();
  if (items.size() == 0) return;
  const std::size_t back = random_->below(plan_->ring_capacity + 2);
  if (back >= items.size()) return;
  const ipc::Word item = items.size() - 1 - back;
  if (!stream_->ring.reader.observe(item, observed_)) return;
  findings_->count(Event::items_observed);
  const Waypoint sent = items.waypoint(item);
  const bool is_waypoint = observed_.kind == ipc::ItemKind::waypoint;
  const bool is_same =
      observed_.kind == items.kind(item) && observed_.time == sent.time &&
      (!is_waypoint ||
       std::ranges::equal(std::span(observed_.values).first(sent.position.size()), sent.position));
  if (is_same) return;
  findings_->breach(Breach::ring_torn, fmt::format("item {}", item));
}

}  // namespace splinecast::campaign
