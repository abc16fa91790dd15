#include "tests/campaign/ends/life.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/fixtures/streams/torn_publication.hpp"

namespace splinecast::campaign::ends {
namespace {

/// A life that takes more steps is left.
constexpr int kMostSteps = 30'000;
/// Number of steps after a finish in which solvers may die.
constexpr int kMostStepsWithDeaths = 20;
/// Number of steps and time from a finish after which it has failed.
constexpr int kMostStepsOfFinish = 2'000;
constexpr Time kLatestEnd = std::chrono::seconds(20);
/// A life without a finish is over this long after its curve rests, or after this number of steps:
/// within tight limits, a stop can take hours.
constexpr int kMostStepsWithoutFinish = 300;
constexpr Time kRests = std::chrono::milliseconds(20);

}  // namespace

Life::Life(const LifePlan& plan, Tally& tally, Random& random)
    : plan_(plan),
      tally_(tally),
      random_(random),
      clock_(plan),
      stream_(plan.stream.dimensions.size(), plan.stream.window, plan.stream.ring_capacity,
              plan.stream.board_capacity, plan.stream.ingest, plan.stream.kinds, plan.stream.live),
      watch_(plan, stream_, tally),
      sampler_(stream_.board.reader,
               plan.stream.live.follows_law ? StreamClock::law : StreamClock::monotonic,
               plan.stream.kinds),
      state_(plan.stream.dimensions.size()),
      end_at_(plan.end_at) {
  stream_.beyond = plan.stream.beyond;
  stream_.replace_solver();
}

ipc::WaypointRingWriter::Solved Life::solved() const {
  return {.consumed = stream_.board.reader.consumed(),
          .settled_until = stream_.board.reader.look().settled_until,
          .clock = &clock_};
}

Waypoint Life::waypoint(std::size_t i) const {
  const std::size_t dimensions = plan_.stream.dimensions.size();
  Waypoint all{.time = plan_.motion.times[i], .position = plan_.motion.value(i, 0, dimensions)};
  if (!plan_.stream.window.interpolant.method->needs_velocity()) return all;
  all.velocity = plan_.motion.value(i, 1, dimensions);
  all.acceleration = plan_.motion.value(i, 2, dimensions);
  return all;
}

bool Life::is_over() const {
  if (tally_.life_failed()) return true;
  const bool acts = end_at_ < Time::max() || was_held_ != (plan_.held_at < Time::max());
  if (acts || is_held_) return false;
  if (!has_asked_) {
    return clock_.now() > watch_.end() + kRests || steps_without_finish_ > kMostStepsWithoutFinish;
  }
  return watch_.summary().finished && clock_.now() > watch_.end();
}

void Life::run() {
  tally_.begin_life(plan_);
  const Time ahead = plan_.stream.live.settle_ahead;
  for (int steps = 0; !is_over(); ++steps) {
    steps_without_finish_ += is_ending_ && !has_asked_ && end_at_ == Time::max() ? 1 : 0;
    if (steps > kMostSteps) return;
    hold_or_release();
    act();
    step();
    sample();
    // The next step: when it is due, or the producer acts.
    Time pause = std::max(stream_.solver.due() - clock_.host(), random_.part(ahead, 0.1, 0.6));
    const Time next = std::min(
        sent_ < plan_.motion.times.size() ? plan_.motion.times[sent_] - plan_.lead : Time::max(),
        std::min(end_at_, is_held_ || was_held_ ? Time::max() : plan_.held_at));
    if (is_held_) pause = std::min(pause, ahead);
    if (!is_held_ && next < Time::max()) {
      const double left = static_cast<double>((next - clock_.now()).count()) / plan_.rate;
      pause = std::min(pause, Time(static_cast<std::int64_t>(std::max(left, 0.0)) + 1));
    }
    constexpr Time kLongest = std::chrono::seconds(100);
    clock_.pass(std::clamp(pause, Time(1000), kLongest));
  }
  if (tally_.life_failed()) return;
  sample_after_end();
  watch_.check_all();
}

void Life::hold_or_release() {
  if (!was_held_ && clock_.now() >= plan_.held_at) {
    is_held_ = was_held_ = true;
    released_at_ = clock_.host() + plan_.held_for;
    if (random_.chance(0.5)) {
      sent_ = plan_.motion.times.size();
      end_at_ = clock_.now();
    }
  }
  if (is_held_ && clock_.host() >= released_at_) is_held_ = false;
  clock_.hold(is_held_);
}

void Life::act() {
  send_waypoints();
  if (end_at_ > clock_.now()) return;
  if (is_ending_) return finish();
  begin_end();
}

void Life::send_waypoints() {
  for (; sent_ < plan_.motion.times.size(); ++sent_) {
    if (plan_.motion.times[sent_] - plan_.lead > clock_.now()) return;
    const auto status = stream_.ring.writer.append(waypoint(sent_), solved());
    if (status == AppendStatus::full) return;
  }
}

void Life::begin_end() {
  is_ending_ = true;
  if (is_held_) tally_.count(Event::held_ends);
  sent_ = plan_.motion.times.size();  // no further waypoint is sent
  switch (plan_.ending) {
    case Ending::finish:
      return finish();
    case Ending::killed:
      end_at_ = Time::max();
      return;
    case Ending::cancel:
      replace_motion();
      break;
    default:
      watch_.note_replacement();
      (void)stream_.ring.writer.replace_from(clock_.now(), {}, solved());
  }
  end_at_ = plan_.ending == Ending::stop ? Time::max() : clock_.now() + plan_.finish_after;
}

/// Replaces the motion by another one, from another waypoint on or back to an earlier one.
void Life::replace_motion() {
  watch_.note_replacement();
  const std::size_t count = plan_.motion.times.size();
  const Time t =
      clock_.now() + plan_.stream.live.settle_ahead + random_.part(plan_.stream.interval, 0, 3);
  std::vector<Waypoint> waypoints;
  Time at = t + random_.part(plan_.stream.live.least_entry, 1, 6);
  const bool goes_back = random_.chance(0.5);
  const std::size_t from = random_.below(count);
  const std::size_t most = 1 + random_.below(8);
  for (std::size_t i = 0; i < std::min(most, goes_back ? from + 1 : count - from); ++i) {
    waypoints.push_back(waypoint(goes_back ? from - i : from + i));
    waypoints.back().time = at;
    at += random_.part(plan_.stream.interval, 0.3, 2);
  }
  (void)stream_.ring.writer.replace_from(t, waypoints, solved());
}

void Life::finish() {
  const auto status = stream_.ring.writer.finish(plan_.stream.end, solved());
  if (status == AppendStatus::full) {
    end_at_ = clock_.now() + plan_.stream.live.settle_ahead;
    return;
  }
  has_asked_ = true;
  asked_at_ = clock_.host();
  end_at_ = Time::max();
}

void Life::step() {
  const bool waits = has_asked_ && !watch_.summary().finished;
  const bool has_work = waits || stream_.ring.reader.written() != stream_.solver.seen();
  // A takeover begins a search again: too many of them would keep it from ending.
  const bool may_die = steps_after_finish_ < kMostStepsWithDeaths;
  if (may_die && random_.chance(has_work ? plan_.takeover : plan_.takeover / 20)) {
    if (waits && steps_after_finish_ > 0) tally_.count(Event::takeovers_in_search);
    if (random_.chance(0.2)) {
      step_and_die();
    } else {
      replace_solver();
    }
  }
  constexpr int kMostAtOnce = 4;
  for (int i = 0; i < kMostAtOnce && !tally_.life_failed(); ++i) {
    const auto result = stream_.solver.step(clock_);
    if (result.damaged) return tally_.breach(Rule::samples, "a damaged board");
    watch_.look(is_held_ ? clock_.now() + Time(1) : Time::max());
    if (result.consumed == 0) break;
  }
  if (!waits) return;
  if (watch_.summary().finished) {
    tally_.count(steps_after_finish_ == 0 ? Event::ends_at_once : Event::searches_postponed);
    return;
  }
  // A finish waits while the board has no room, and for a replacement that is not due.
  if (++steps_after_finish_ > kMostStepsOfFinish && clock_.host() > asked_at_ + kLatestEnd) {
    tally_.breach(Rule::finishes, fmt::format("{} steps, {} s", steps_after_finish_,
                                              to_seconds(clock_.host() - asked_at_)));
  }
}

void Life::replace_solver() {
  tally_.count(Event::takeovers);
  try {
    stream_.replace_solver();
  } catch (const std::exception& error) {
    tally_.breach(Rule::samples, error.what());
  }
}

/// Steps a solver that dies before, within or after its commit; another one takes over.
void Life::step_and_die() {
  testing::TornPublication torn(stream_.board);
  (void)stream_.solver.step(clock_);
  const std::size_t how = random_.below(3);
  if (how == 0) {
    torn.take_back_commit();
  } else if (how == 1) {
    torn.take_back_rest();
    watch_.look(is_held_ ? clock_.now() + Time(1) : Time::max());
  } else {
    const double share = random_.unit();
    torn.take_back([&] { return random_.chance(share); });
  }
  tally_.count(Event::torn_takeovers);
  replace_solver();
}

/// A sample at now has the values of the published curve.
void Life::sample() {
  const Time t = clock_.now();
  const auto status = sampler_.sample(t, state_);
  if (!watch_.has_curve()) return;
  if (!has_values(status)) {
    if (t < watch_.begin() || status == SampleStatus::before_history) return;
    return tally_.breach(Rule::samples, fmt::format("no values: {}", to_string(status)));
  }
  if (t < watch_.begin() || t > watch_.end()) return;
  const Piece& piece = watch_.at(t);
  const double u = to_seconds(t - piece.left);
  for (std::size_t d = 0; d < state_.dimensions(); ++d) {
    if (plan_.stream.dimensions[d].kind != DimensionKind::linear) continue;
    const double x = watch_.ranges().value(piece, d, 0, u);
    const double scale = watch_.ranges().scale(piece, d, 0);
    if (std::abs(state_.position()[d] - x) <= 1e-9 * scale) continue;
    return tally_.breach(Rule::samples,
                         fmt::format("{} at {} ns, published {}", state_.position()[d],
                                     (t - plan_.stream.begin).count(), x));
  }
}

/// After its end, the curve holds at its last position.
void Life::sample_after_end() {
  if (!watch_.has_curve()) return;
  const Time end = watch_.end();
  State rest(state_.dimensions());
  const auto first = sampler_.preview(end, rest.ref());
  const auto later = sampler_.preview(end + std::chrono::seconds(1000), state_.ref());
  if (!has_values(first) || !has_values(later)) {
    return tally_.breach(Rule::samples, "no values after the end");
  }
  for (std::size_t d = 0; d < state_.dimensions(); ++d) {
    const double off = std::abs(state_.position()[d] - rest.position()[d]);
    const double turns = std::abs(state_.velocity()[d]) + std::abs(state_.acceleration()[d]);
    const bool wraps = plan_.stream.dimensions[d].kind != DimensionKind::linear;
    if (turns == 0 && (wraps || off <= 1e-9 * (1 + std::abs(rest.position()[d])))) continue;
    return tally_.breach(Rule::ends_at_rest,
                         fmt::format("dimension {} moves after the end: {} away", d, off));
  }
}

}  // namespace splinecast::campaign::ends
