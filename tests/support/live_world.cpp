#include "support/live_world.hpp"
#include "splinecast/core/stop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "splinecast/core/segment.hpp"
#include "support/torn_publication.hpp"

namespace splinecast::testing {

using core::Time;
using std::chrono::microseconds;
using std::chrono::milliseconds;

namespace {

constexpr Time kStart = Motion::kStart;
constexpr Time kTick = milliseconds(1);
constexpr Time kInterval = milliseconds(10);
/// At a depth of one knot every waypoint comes when the one before it has been frozen: each is
/// entered by a splice of its own.
constexpr Time kLeastLead = milliseconds(16);
/// How far ahead a producer sends its waypoints after the machine has stopped, so that with the
/// acceleration allowed it can catch up with the motion.
constexpr Time kCatchUp = milliseconds(600);
/// Waypoints closer than this leave a frozen velocity no time to be made good.
constexpr ipc::IngestLimits kLimits{.min_interval = milliseconds(5)};

core::WindowOptions window_of(const WorldOptions& options, const Motion& motion) {
  core::WindowOptions window = options.window;
  window.start = {.kind = core::ConditionKind::halt, .value = {}};
  window.held_before_start = true;
  if (options.has_limits) {
    window.limits.acceleration = motion.peak_acceleration();
    for (double& limit : window.limits.acceleration) limit *= 10;
  }
  return window;
}

}  // namespace

LiveWorld::LiveWorld(const WorldOptions& options)
    : options_(options),
      random_(options.seed),
      motion_(options.seed, options.dimensions),
      clock_(now_, [this](Time t) { advance_to(t); }),
      stream_(options.dimensions, window_of(options, motion_), 256, 1024, kLimits, {},
              ipc::LiveOptions{}),
      sampler_(stream_.board.reader, ipc::StreamClock::monotonic),
      watch_(sampler_, options.dimensions),
      items_(options.dimensions),
      collected_(stream_.board.reader),
      now_(kStart),
      next_tick_(kStart),
      next_waypoint_(kStart + milliseconds(100)),
      lead_(milliseconds(80)) {
  stream_.replace_producer();
  if (!options.starts_in_motion) return;
  const Time t = kStart + milliseconds(50);
  const auto x = motion_.at(t);
  const auto v = motion_.at(t, 1);
  const auto a = motion_.at(t, 2);
  EXPECT_EQ(stream_.ring.writer.start_from({t, x, v, a}, {}), ipc::AppendStatus::accepted);
}

double LiveWorld::ideal_peak() const { return std::ranges::max(motion_.peak_acceleration()); }

bool LiveWorld::happens(double per_second, Time within) {
  std::uniform_real_distribution<double> unit(0, 1);
  return unit(random_) < per_second * core::to_seconds(within);
}

Time LiveWorld::between(std::int64_t low_us, std::int64_t high_us) {
  return microseconds(std::uniform_int_distribution<std::int64_t>(low_us, high_us)(random_));
}

void LiveWorld::run(Time duration) {
  const Time end = now_ + duration;
  while (now_ < end) {
    if (happens(options_.pauses, microseconds(500))) {
      ++pauses;
      // Between two steps, behind the first look at the clock, or directly before the commit.
      const auto look = std::uniform_int_distribution<std::size_t>(0, 2)(random_);
      const Time pause = between(1'000, 200'000);
      if (look == 0) {
        advance_to(now_ + pause);
      } else {
        clock_.stop_behind_reading(look, pause);
      }
    }
    step_solver();
    clock_.restart();
    if (happens(options_.solver_kills, microseconds(500))) kill_solver();
    advance_to(now_ + between(100, 900));
  }
}

void LiveWorld::step_solver() {
  note_items();
  const auto before = stream_.solver.head().misses;
  const auto result = stream_.solver.step(clock_);
  EXPECT_EQ(stream_.solver.head().misses, before + (result.missed ? 1 : 0));
  note_items();
  collected_.look();
  if (result.published) check_settled();
}

/// What the ring holds, before it is overwritten, and what has been refused of it.
void LiveWorld::note_items() {
  items_.note_items(stream_.ring.reader);
  items_.note_refusals(stream_.board.reader, stream_.solver.head().refused);
}

ipc::Verification LiveWorld::verify() const {
  return ipc::verify({.window = stream_.window,
                      .kinds = stream_.kinds,
                      .items = items_.items(),
                      .segments = collected_.segments(),
                      .head = collected_.head(),
                      .end = {.kind = core::ConditionKind::halt, .value = {}}});
}

/// All else goes on until t.
void LiveWorld::advance_to(Time t) {
  while (next_tick_ <= t) {
    now_ = std::max(now_, next_tick_);
    tick();
    next_tick_ += kTick;
  }
  now_ = std::max(now_, t);
}

void LiveWorld::tick() {
  watch_.tick(now_);
  expect_passed();
  produce();
}

void LiveWorld::produce() {
  if (happens(options_.producer_kills, kTick)) {
    ++producer_kills;
    stream_.replace_producer();
  }
  if (now_ < silent_until_) return;
  if (happens(options_.starvations, kTick)) {
    ++starved;
    silent_until_ = now_ + lead_ + between(10'000, 600'000);
    // A machine that has stopped needs time to catch up with the motion again.
    lead_ = kCatchUp;
    return;
  }
  if (happens(options_.replacements, kTick)) return replace();
  const bool may_change_lead = now_ > kStart + milliseconds(300);
  if (may_change_lead && happens(5, kTick)) {
    lead_ = kLeastLead + kInterval * std::uniform_int_distribution<int>(
                                         0, static_cast<int>(options_.max_lead_knots) - 1)(random_);
  }
  if (may_change_lead && happens(0.5, kTick)) lead_ = kLeastLead;
  // A producer that knows its trade skips what has gone by.
  while (next_waypoint_ < now_ + milliseconds(6)) next_waypoint_ += kInterval;
  while (next_waypoint_ - lead_ <= now_) {
    const Time t = next_waypoint_ + between(-2'000, 2'000);
    send(t, motion_.at(t));
    next_waypoint_ += kInterval;
  }
}

void LiveWorld::run_quietly(Time duration) {
  const Time end = now_ + duration;
  while (now_ < end) {
    step_solver();
    advance_to(now_ + milliseconds(1));
  }
}

void LiveWorld::send(Time t, std::vector<double> x) {
  const ipc::Word item = stream_.ring.writer.head();
  const auto status = stream_.ring.writer.append(
      {.time = t, .position = x}, {stream_.board.reader.tail(), sampler_.settled_until()});
  if (status != ipc::AppendStatus::accepted) return;
  ++sent;
  on_the_way_.push_back({.time = t, .item = item, .position = std::move(x)});
}

void LiveWorld::replace() {
  const Time t = now_ + between(6'000, 120'000);
  const auto count = std::uniform_int_distribution<std::size_t>(0, 30)(random_);
  if (replace_from(t, count) == ipc::AppendStatus::accepted) ++replaced;
}

/// Replaces what lies behind t by `count` waypoints of the motion, or by nothing.
ipc::AppendStatus LiveWorld::replace_from(Time t, std::size_t count) {
  std::vector<std::vector<double>> positions;
  std::vector<core::Waypoint> waypoints;
  std::vector<Sent> sent_now;
  const ipc::Word item = stream_.ring.writer.head();
  const ipc::Word taken = stream_.board.reader.tail();
  for (std::size_t i = 0; i < count; ++i) {
    const Time at = t + kInterval * (static_cast<int>(i) + 1) + between(0, 2'000);
    positions.push_back(motion_.at(at));
    sent_now.push_back({.time = at, .item = item + 1 + i, .position = positions.back()});
  }
  for (std::size_t i = 0; i < count; ++i) {
    waypoints.push_back({.time = sent_now[i].time, .position = positions[i]});
  }
  const auto status =
      stream_.ring.writer.replace_from(t, waypoints, {taken, sampler_.settled_until()});
  if (status != ipc::AppendStatus::accepted) return status;
  sent += count;
  // What it withdraws need not be passed through: what lies behind t, and, if it takes effect
  // before its turn, what has not been taken yet. If the solver refuses it, it may be.
  std::erase_if(on_the_way_, [t, taken](const Sent& waypoint) {
    return waypoint.time >= t || waypoint.item >= taken;
  });
  on_the_way_.insert(on_the_way_.end(), sent_now.begin(), sent_now.end());
  if (count < 3) lead_ = kCatchUp;
  next_waypoint_ = (count == 0 ? t : sent_now.back().time) + kInterval;
  return status;
}

void LiveWorld::stop_behind_misses() {
  step_solver();
  silent_until_ = now_ + milliseconds(200);
  const Time settled = head().settled_until;
  (void)replace_from(settled, 3);
  (void)replace_from(std::max(settled, head().newest_knot) + milliseconds(300), 3);
  advance_to(now_ + milliseconds(20));
  ASSERT_EQ(replace_from(settled, 0), ipc::AppendStatus::accepted);
  const ipc::Word stop = stream_.ring.writer.head();
  const bool was_finished = head().finished;
  step_solver();
  EXPECT_FALSE(was_finished);
  EXPECT_EQ(head().consumed, stop) << "seed " << options_.seed;
  EXPECT_LE(head().newest_knot, head().settled_until) << "seed " << options_.seed;
  ++stops;
  next_waypoint_ = now_ + kCatchUp;
}

/// Every waypoint whose time has come is passed through, has been refused by its number, or lies
/// where the curve is not on its target.
void LiveWorld::expect_passed() {
  const bool smooths = options_.window.interpolant.method->family == core::Family::smoothing;
  core::State state(options_.dimensions);
  while (!on_the_way_.empty() && on_the_way_.front().time <= now_) {
    const Sent waypoint = on_the_way_.front();
    on_the_way_.pop_front();
    if (stream_.board.reader.tail() <= waypoint.item) continue;  // the solver stands: late, refused
    const ipc::Head& head = stream_.solver.head();
    bool is_refused = false;
    for (ipc::Word k = 0; k < std::min<ipc::Word>(head.refused, ipc::kRefusalsKept); ++k) {
      is_refused =
          is_refused || stream_.board.reader.refusal(head.refused - 1 - k).item == waypoint.item;
    }
    if (is_refused) continue;
    ASSERT_TRUE(ipc::has_values(sampler_.preview(waypoint.time, state.ref())));
    // The end of an entry may be a waypoint too: then the curve has its bits there.
    const bool is_there = std::ranges::equal(state.position(), waypoint.position);
    if (!is_there && !is_on_target(waypoint.time)) {
      ++passed_over;
      continue;
    }
    for (std::size_t d = 0; d < options_.dimensions; ++d) {
      ASSERT_NEAR(state.position()[d], waypoint.position[d], smooths ? 1e-3 : 1e-9)
          << "seed " << options_.seed << ", item " << waypoint.item;
    }
    ++interpolated;
  }
}

/// Whether a piece of the target goes on from t: it must pass a waypoint there.
bool LiveWorld::is_on_target(Time t) {
  ipc::Snapshot snapshot(options_.dimensions);
  if (!ipc::has_values(sampler_.snapshot(t, t + Time(1), snapshot))) return false;
  if (snapshot.segments().empty()) return false;
  const ipc::SegmentCopy& segment = snapshot.segments().front();
  return segment.has_waypoint && (segment.kind == core::SegmentKind::spline || segment.left == t);
}

/// Segments that end at or before settled_until, as they are published: no revision changes one.
void LiveWorld::check_settled() {
  const auto& board = stream_.board.reader;
  const ipc::Head& head = stream_.solver.head();
  ipc::BoardSegment segment(options_.dimensions, board.smooths());
  ipc::SegmentCopy copy;
  constexpr ipc::Word kBack = 40;
  const ipc::Word oldest = std::max(head.first, head.newest - std::min(head.newest, kBack));
  for (ipc::Word n = oldest; n <= head.newest && n > 0; ++n) {
    const auto taken = segment.take(board, head, n);
    ASSERT_NE(taken, ipc::BoardSegment::Taken::torn);
    if (taken == ipc::BoardSegment::Taken::none) continue;
    if (segment.right() > head.settled_until) break;
    segment.copy_to(copy);
    std::vector<double> words = copy.coefficients;
    words.push_back(static_cast<double>((copy.left - kStart).count()));
    words.push_back(static_cast<double>((copy.right - kStart).count()));
    const auto at = settled_.try_emplace(n, words).first;
    EXPECT_EQ(at->second, words) << "seed " << options_.seed << ", segment " << n;
  }
  while (!settled_.empty() && settled_.begin()->first < oldest) settled_.erase(settled_.begin());
}

/// Dies between two steps, or with all words of a revision written and its commit missing.
void LiveWorld::kill_solver() {
  ++solver_kills;
  if (happens(1000, milliseconds(1) / 2)) {
    TornPublication torn(stream_.board);
    stream_.clock.time = now_;
    stream_.solver.step(stream_.clock);
    torn.take_back_commit();
  }
  stream_.replace_solver();
}

/// Comes to rest along the motion's stop tail, as a producer does that means to end, and finishes.
void LiveWorld::finish() {
  constexpr Time kStop = milliseconds(800);
  silent_until_ = Time::max();
  run_quietly(kInterval);  // the solver has had its say about everything sent
  if (head().starved) next_waypoint_ = std::max(next_waypoint_, now_ + kCatchUp);
  const Time from = std::max({next_waypoint_, stream_.ring.writer.last_time() + kInterval,
                              head().newest_knot + kInterval});
  core::Segment stop(options_.dimensions);
  core::build_stop(from, kStop, motion_.at(from), motion_.at(from, 1), motion_.at(from, 2), stop);
  core::State state(options_.dimensions);
  for (Time t = from; t <= from + kStop; t += kInterval) {
    core::evaluate(stop.order, stop.coefficients, core::to_seconds(t - from), state.ref());
    send(t, {state.position().begin(), state.position().end()});
    if (t - now_ > kCatchUp) run_quietly(kInterval);
  }
  while (stream_.ring.writer.finish({.kind = core::ConditionKind::halt, .value = {}},
                                    {stream_.board.reader.tail()}) == ipc::AppendStatus::full) {
    step_solver();
  }
  const auto last = on_the_way_.empty() ? std::vector<double>{} : on_the_way_.back().position;
  run_quietly(std::chrono::seconds(2));
  EXPECT_TRUE(head().finished);
  ASSERT_EQ(watch_.tick(now_), ipc::SampleStatus::holding);
  for (std::size_t d = 0; d < last.size(); ++d) {
    EXPECT_NEAR(watch_.state().position()[d], last[d], 1e-9);
  }
}

}  // namespace splinecast::testing
