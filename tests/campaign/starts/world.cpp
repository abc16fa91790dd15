#include "tests/campaign/starts/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/campaigns.hpp"

namespace splinecast::campaign::starts {
namespace {

using std::chrono::milliseconds;

constexpr double kPeriod = 6.283185307179586;

}  // namespace

World::World(std::uint64_t seed, Random& random, Facts& facts)
    : seed_(seed),
      random_(random),
      facts_(facts),
      name_(campaign_stream("starts")),
      clock_(random),
      dimensions_(1 + random.below(3)),
      has_quaternion_(random.chance(0.3)),
      is_periodic_(random.chance(0.3)),
      sampled_(1) {
  if (has_quaternion_) dimensions_ += kQuaternionSize;
  sampled_ = State(dimensions_);
  how_.limits = MotionLimits{.velocity = {kVelocity}, .acceleration = {kAcceleration}};
  how_.beyond = random.chance(0.5) ? Beyond::enter : Beyond::report;
  how_.capacity = 256;
  how_.wake = false;
  start_solver();
}

World::~World() {
  reader_.reset();
  observer_.reset();
  solver_.reset();
  try {
    remove();
  } catch (const std::exception&) {
    reader_.reset();  // the next campaign of this process uses other names
  }
}

ProducerOptions World::producer_options() const {
  ProducerOptions options{.dimensions = dimensions_};
  options.kinds.assign(dimensions_, {});
  if (is_periodic_) options.kinds[0] = {.kind = DimensionKind::periodic, .period = kPeriod};
  if (has_quaternion_) {
    for (std::size_t i = dimensions_ - kQuaternionSize; i < dimensions_; ++i) {
      options.kinds[i].kind = DimensionKind::quaternion;
    }
  }
  options.capacity = 64;
  return options;
}

std::vector<double> World::position(double s) const {
  std::vector<double> position(dimensions_);
  for (std::size_t d = 0; d < linear(); ++d) position[d] = s + static_cast<double>(d);
  if (has_quaternion_) {
    position[linear()] = std::cos(s / 2);
    position[linear() + 3] = std::sin(s / 2);
  }
  return position;
}

double World::distance(std::span<const double> from, std::span<const double> to) const {
  double largest = 0;
  for (std::size_t d = 0; d < linear(); ++d) {
    const double way = to[d] - from[d];
    const bool wraps = is_periodic_ && d == 0;
    largest = std::max(largest, std::abs(wraps ? std::remainder(way, kPeriod) : way));
  }
  double less = 0;
  double more = 0;
  for (std::size_t d = linear(); d < dimensions_; ++d) {
    less = std::hypot(less, to[d] - from[d]);
    more = std::hypot(more, to[d] + from[d]);
  }
  return std::max(largest, 4 * std::asin(std::min(1.0, std::min(less, more) / 2)));
}

std::optional<std::vector<double>> World::position_at(Time t, std::uint64_t stream) {
  State at(dimensions_);
  try {
    const bool is_open = observer_ && ipc::Internals::header(*observer_).stream_id == stream;
    if (!is_open || observer_->sample(t, at) == SampleStatus::retired) observer_.emplace(name_);
    if (ipc::Internals::header(*observer_).stream_id != stream) return std::nullopt;
    if (!has_values(observer_->sample(t, at))) return std::nullopt;
  } catch (const StreamError&) {
    return std::nullopt;
  }
  return std::vector<double>(at.position().begin(), at.position().end());
}

void World::start_solver() {
  asleep_until_ = {};
  if (!solver_) solver_.emplace(name_, how_);
}

void World::disturb_solver() {
  const double what = random_.unit();
  if (what < 0.15) {
    solver_.reset();
    asleep_until_ = clock_.now() + random_.between(Time(0), milliseconds(300));
    facts_.count(Event::solver_restarts);
  } else if (what < 0.4) {
    asleep_until_ = clock_.now() + random_.between(Time(0), milliseconds(60));
    facts_.count(Event::solver_pauses);
  }
}

const ipc::Summary* World::summary() const noexcept {
  return has_solver() ? &ipc::Internals::summary(*solver_) : nullptr;
}

void World::remove() {
  solver_.reset();
  try {
    remove_stream(name_);
  } catch (const NoSuchStream&) {
    asleep_until_ = {};
  }
}

void World::tick() {
  clock_.advance(kTick);
  if (clock_.now() >= asleep_until_) {
    start_solver();
    if (solver_->attached() || solver_->attach(clock_)) (void)solver_->step(clock_);
  }
  control();
}

void World::attach() {
  try {
    reader_.emplace(name_);
    counted_ = 0;
    const bool is_other = only_ && ipc::Internals::header(*reader_).stream_id != *only_;
    if (!is_other) return only_.reset();
    reader_.reset();
    attaches_at_ = clock_.now() + milliseconds(20);
  } catch (const StreamError&) {
    reader_.reset();
  }
}

/// One cycle of a controller: follows the curve, and attaches again when its board is retired.
void World::control() {
  const Time now = clock_.now();
  if (!reader_ && now >= attaches_at_) attach();
  if (!reader_) return;
  const SampleStatus status = reader_->sample(now, sampled_);
  if (status == SampleStatus::retired) {
    facts_.count(Event::samples_of_other_boards);
    reader_.reset();
    attaches_at_ = now + random_.between(Time(0), milliseconds(4));
    return;
  }
  if (!has_values(status)) return;
  ipc::Summary summary;
  if (ipc::Internals::summary(*reader_, summary)) {
    counted_ = summary.exceeding;
    if (status == SampleStatus::revised && summary.late_commits == 0) {
      facts_.breach(Breach::revised, seed_, fmt::format("at {}", now.count()));
    }
  }
  facts_.count(Event::samples);
  const std::vector<double> before = std::exchange(
      held_, std::vector<double>(sampled_.position().begin(), sampled_.position().end()));
  compare(now, before);
  held_at_ = now;
}

/// Compares a sample with the one before and with the limits.
void World::compare(Time now, std::span<const double> before) {
  constexpr Time kMissed{8'000'000};  // while it attaches to another board
  constexpr double kRounding = 1e-6;
  if (counted_ > 0) return;
  if (!before.empty()) {
    const double most = kVelocity * to_seconds(std::min(now - held_at_, kMissed)) + kRounding;
    const double way = distance(before, held_);
    if (way > most) {
      facts_.breach(Breach::step, seed_,
                    fmt::format("{} at {}, {} s after the sample before", way, now.count(),
                                to_seconds(now - held_at_)));
    }
  }
  compare_limits();
}

void World::compare_limits() {
  constexpr double kMargin = 1 + 1e-6;
  for (std::size_t d = 0; d < linear(); ++d) {
    const double velocity = std::abs(sampled_.velocity()[d]);
    const double acceleration = std::abs(sampled_.acceleration()[d]);
    facts_.largest_velocity = std::max(facts_.largest_velocity, velocity);
    facts_.largest_acceleration = std::max(facts_.largest_acceleration, acceleration);
    if (velocity <= kVelocity * kMargin && acceleration <= kAcceleration * kMargin) continue;
    facts_.breach(Breach::uncounted, seed_,
                  fmt::format("velocity {}, acceleration {} of dimension {} at {}", velocity,
                              acceleration, d, held_at_.count()));
  }
}

}  // namespace splinecast::campaign::starts
