#include "tests/campaign/starts/beginnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <utility>

#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::campaign::starts {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kPatience = seconds(20);

Time realtime() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return Time(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec);
}

}  // namespace

double Path::at(Time t) const noexcept {
  const double phase = frequency * std::max(to_seconds(t - begin), 0.0);
  return from + amplitude * (1 - std::cos(phase));
}

Beginnings::Beginnings(std::uint64_t seed, Random& random, Facts& facts)
    : seed_(seed),
      random_(random),
      facts_(facts),
      world_(seed, random, facts),
      items_(seed, world_, facts) {}

void Beginnings::play(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) begin();
  if (producer_) finish();
  world_.pass(milliseconds(500));
}

Path Beginnings::new_path(Time begin) {
  Path path{.begin = begin};
  path.frequency = random_.log_uniform(0.5, 6);
  path.amplitude =
      random_.uniform(0.1, 1) *
      std::min(kVelocity / 2 / path.frequency, kAcceleration / 2 / path.frequency / path.frequency);
  path.from = random_.chance(0.3) ? path_.at(begin) : random_.uniform(-0.8, 0.8);
  return path;
}

void Beginnings::begin() {
  facts_.count(Event::beginnings);
  create();
  if (random_.chance(0.15)) send_other_clock();
  if (random_.chance(0.06) && !producer_->continues()) {
    facts_.count(Event::empty_streams);
    return finish();
  }
  const bool is_brief = random_.chance(0.2);
  if (send_first() && !is_brief) move_on();
  if (!is_brief) return end();
  // A program that sends all of its waypoints at once, and ends.
  facts_.count(Event::brief_streams);
  for (int i = 0; i < 8; ++i, next_ += interval_) (void)append(next_);
  finish();
}

void Beginnings::create() {
  world_.disturb_solver();
  producer_.emplace(
      ipc::Internals::producer(world_.name(), world_.producer_options(), world_.clock()));
  items_.begin(*producer_);
  if (!producer_->continues()) {
    facts_.count(is_removed_ ? Event::created_after_rm : Event::created);
  }
  is_removed_ = false;
  // A producer that does not wait for its solver sometimes.
  if (random_.chance(0.7)) world_.pass(random_.between(Time(0), milliseconds(20)));
}

void Beginnings::send_other_clock() {
  const Time now = world_.clock().now();
  const std::array other{realtime(), Time(realtime().count() / 1000), realtime() / 1'000'000'000,
                         Time(now.count() / 1'000'000'000), now + std::chrono::hours(3)};
  const std::vector<double> x = world_.position(random_.uniform(-1, 1));
  for (std::size_t i = 0; i < 3; ++i) {
    const Waypoint waypoint{.time = other[random_.below(other.size())], .position = x};
    const bool replaces = random_.chance(0.3);
    const AppendStatus status = replaces ? producer_->replace_from(waypoint.time, {&waypoint, 1})
                                         : producer_->append(waypoint);
    facts_.count(Event::other_clocks);
    if (status == AppendStatus::accepted) {
      facts_.breach(Breach::other_clock, seed_, fmt::format("time {}", waypoint.time.count()));
    }
  }
}

/// Sends the first waypoint until it is accepted. Returns whether it is.
bool Beginnings::send_first() {
  constexpr int kTries = 60;
  interval_ = random_.between(milliseconds(5), milliseconds(30));
  lead_ = random_.between(milliseconds(60), milliseconds(400));
  const bool continues = producer_->continues();
  const Time settled = producer_->earliest();
  const bool moves = continues && producer_->last_time() > settled;
  if (continues) {
    facts_.count(moves ? Event::continued_in_motion : Event::continued_at_rest);
  }
  const bool extends = continues && random_.chance(0.4);
  Time margin = random_.between(milliseconds(-10), milliseconds(50));
  for (int i = 0; i < kTries; ++i) {
    const Time t = extends ? std::max(producer_->last_time() + interval_, producer_->earliest())
                           : producer_->earliest() + margin;
    if (!extends) path_ = new_path(t);
    const std::uint64_t items = producer_->appended();
    const AppendStatus status = try_first(t);
    note(status);
    if (status == AppendStatus::accepted) {
      if (continues && producer_->appended() > items + 1) facts_.count(Event::motions_replaced);
      next_ = t + interval_;
      return true;
    }
    if (status == AppendStatus::elsewhere) choose_start(t);
    margin = std::min<Time>(std::max(margin, Time(0)) * 3 / 2 + milliseconds(10), seconds(2));
    world_.pass(random_.between(milliseconds(1), milliseconds(100)));
  }
  facts_.breach(
      Breach::never_begins, seed_,
      fmt::format("at {}, solver {}, last time {}, continues {}", world_.clock().now().count(),
                  world_.has_solver(), producer_->last_time().count(), continues));
  return false;
}

AppendStatus Beginnings::try_first(Time t) {
  const double how = random_.unit();
  if (how < 0.1) return replace(t, false);
  if (how < 0.2) return replace(t, true);
  return append(t);
}

AppendStatus Beginnings::append(Time t) {
  const double s = path_.at(t);
  const std::vector<double> x = world_.position(s);
  const AppendStatus status = producer_->append({.time = t, .position = x});
  if (status == AppendStatus::accepted) items_.note(*producer_, s);
  return status;
}

/// Begins with a replacement by one waypoint that is a little later.
AppendStatus Beginnings::replace(Time t, bool is_soonest) {
  const std::vector<double> x = world_.position(path_.at(t + interval_));
  const Waypoint waypoint{.time = t + interval_, .position = x};
  const std::span<const Waypoint> path(&waypoint, 1);
  const AppendStatus status =
      is_soonest ? producer_->replace_from(path) : producer_->replace_from(t, path);
  if (status == AppendStatus::accepted) {
    items_.note(*producer_, path_.at(waypoint.time), 1);
    facts_.count(is_soonest ? Event::starts_replaced_soonest : Event::starts_replaced);
  }
  return status;
}

/// Says where the machine is, as the message of a refused first waypoint names it.
void Beginnings::choose_start(Time t) {
  const double how = random_.unit();
  const std::vector<double> zeros(world_.dimensions());
  const Instant old = producer_->old_end();
  if (old.position.empty() || how < 0.2) return;  // not known yet; tries again, later
  if (how < 0.5) {
    if (producer_->start_from(old) == AppendStatus::accepted) {
      facts_.count(Event::starts_from_old_end);
    }
  } else if (how < 0.75) {
    const std::vector<double> x(old.position.begin(), old.position.end());
    const Instant measured{old.time, x, zeros, zeros};
    if (producer_->start_from(measured) == AppendStatus::accepted) {
      facts_.count(Event::starts_measured);
    }
  } else {
    const std::vector<double> x = world_.position(path_.at(t));
    if (producer_->start_from({.time = t, .position = x}, {.moved = true}) ==
        AppendStatus::accepted) {
      facts_.count(Event::starts_moved);
      world_.move(producer_->stream_id());
    }
  }
}

void Beginnings::note(AppendStatus status) {
  if (status == AppendStatus::elsewhere) facts_.count(Event::refused_as_elsewhere);
  if (status == AppendStatus::past) facts_.count(Event::refused_as_past);
  if (status == AppendStatus::too_late) facts_.count(Event::refused_as_too_late);
}

/// Sends the waypoints of the path until `until`, as far ahead as the lead.
void Beginnings::send_waypoints(Time until) {
  while (world_.clock().now() < until) {
    while (next_ < world_.clock().now() + lead_) {
      if (append(next_) == AppendStatus::full) break;
      next_ += interval_;
    }
    world_.pass(milliseconds(4));
    if (random_.chance(0.1)) items_.check(*producer_, false);
  }
}

/// The motion, with an occasional replacement.
void Beginnings::move_on() {
  const Time end = world_.clock().now() + random_.between(Time(0), milliseconds(700));
  if (random_.chance(0.3)) {
    send_waypoints(std::min(end, world_.clock().now() + milliseconds(200)));
    world_.disturb_solver();
    const Time t = producer_->earliest() + random_.between(milliseconds(-10), milliseconds(50));
    const Path before = std::exchange(path_, new_path(t));
    const AppendStatus status = replace(t, random_.chance(0.5));
    note(status);
    if (status == AppendStatus::accepted) {
      next_ = t + 2 * interval_;
    } else {
      path_ = before;
    }
    send_waypoints(world_.clock().now() + milliseconds(8));
    const auto begin = producer_->replacement_begin();
    if (begin && begin->begin > t) facts_.count(Event::late_replacements);
  }
  send_waypoints(end);
}

void Beginnings::end() {
  const double how = random_.unit();
  if (how < 0.45) return kill();
  if (how < 0.55 && producer_->replace_from({}) == AppendStatus::accepted) {
    items_.note(*producer_, std::nullopt);
  }
  finish();
  if (how > 0.92) {
    producer_.reset();
    world_.remove();
    world_.move(0);
    is_removed_ = true;
  }
  world_.pass(random_.chance(0.5) ? random_.between(Time(0), milliseconds(40))
                                  : random_.between(Time(0), seconds(2)));
}

/// The producer dies; another one follows later.
void Beginnings::kill() {
  facts_.count(Event::kills);
  producer_.reset();
  world_.pass(random_.chance(0.5) ? random_.between(Time(0), milliseconds(60))
                                  : random_.between(Time(0), seconds(1)));
}

void Beginnings::finish() {
  facts_.count(Event::finishes);
  world_.pass_until(kPatience, [this] {
    const AppendStatus status = producer_->finish();
    if (status == AppendStatus::accepted) items_.note(*producer_, std::nullopt);
    return status == AppendStatus::accepted || status == AppendStatus::finished;
  });
  if (random_.chance(0.4)) return producer_.reset();  // does not wait for the solver
  const bool is_consumed = world_.pass_until(kPatience, [this] {
    (void)producer_->earliest();
    return producer_->consumed() == producer_->appended();
  });
  if (!is_consumed) {
    facts_.breach(Breach::never_consumed, seed_,
                  fmt::format("{} of {}", producer_->consumed(), producer_->appended()));
  }
  items_.check(*producer_, is_consumed);
  check_accounts();
  producer_.reset();
}

void Beginnings::check_accounts() {
  const ipc::Summary* const summary = world_.summary();
  if (summary == nullptr || !summary->finished) return;
  const std::uint64_t known =
      summary->knots + summary->refused + summary->withdrawn + summary->controls;
  if (summary->consumed != known) {
    facts_.breach(Breach::accounts, seed_, fmt::format("{} of {}", known, summary->consumed));
  }
  const auto late = summary->reasons[static_cast<std::size_t>(Refusal::too_late)];
  if (late > 0) facts_.breach(Breach::too_late, seed_, fmt::format("{} items", late));
  facts_.events[static_cast<std::size_t>(Event::excesses_counted)] += summary->exceeding;
}

}  // namespace splinecast::campaign::starts
