#include "tests/campaign/motions/stops.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/limits/extremes.hpp"
#include "ipc/sampling/snapshot.hpp"

namespace splinecast::campaign {
namespace {

constexpr double kLead = 0.06;   // s
constexpr double kMeasured = 2;  // s: measured from here on, after the start
constexpr double kRounding = 1e-9;

Schedule schedule_of(const Sines& motion, const Data& data, double until) {
  Schedule schedule = steady(motion, data.rate, kLead);
  std::erase_if(schedule.calls, [&](const Call& call) { return call.at > until; });
  return schedule;
}

/// Ranges and values of a segment in closed form.
struct Look {
  const ipc::SegmentCopy& segment;
  std::size_t dimensions;

  [[nodiscard]] double seconds() const { return to_seconds(segment.right - segment.left); }
  [[nodiscard]] core::SegmentRange range(std::size_t joint, int derivative) const {
    return core::range_of(segment.order, segment.coefficients, dimensions, joint, derivative, 0,
                          seconds());
  }
  [[nodiscard]] double at(std::size_t joint, double u, int derivative) const {
    const auto range =
        core::range_of(segment.order, segment.coefficients, dimensions, joint, derivative, u, u);
    return range.least.value;
  }
  [[nodiscard]] double largest(std::size_t joint, int derivative) const {
    return std::abs(range(joint, derivative).largest().value);
  }
};

double seconds_at(Time t) { return to_seconds(t - Trial::stream_time(0)); }

class Measuring {
 public:
  Measuring(const Sines& motion, StopMeasures& measures) : motion_(motion), measures_(measures) {}

  /// Measures the two newest published segments.
  void look(std::span<const ipc::SegmentCopy> segments) {
    const bool is_stop = segments.size() >= 2 && segments.back().kind == SegmentKind::stop &&
                         segments[segments.size() - 2].kind == SegmentKind::spline;
    if (!is_stop) {
      ++measures_.in_entries;
      return;
    }
    const ipc::SegmentCopy& last = segments[segments.size() - 2];
    ++measures_.stops;
    for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
      look_at_stop({segments.back(), Sines::kJoints}, joint);
      look_at_last({last, Sines::kJoints}, joint);
    }
  }

  void read(const Sight& sight) {
    for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
      const double error = std::abs(sight.state->position()[joint] - motion_.at(joint, sight.t));
      measures_.read_error = std::max(measures_.read_error, error);
      measures_.read_acceleration =
          std::max(measures_.read_acceleration, std::abs(sight.state->acceleration()[joint]));
    }
  }

 private:
  void look_at_stop(const Look& stop, std::size_t joint) {
    const double t = seconds_at(stop.segment.left);
    const double length = stop.seconds();
    const double velocity = stop.at(joint, 0, 1);
    const double distance = std::abs(stop.at(joint, length, 0) - stop.at(joint, 0, 0));
    const auto range = stop.range(joint, 1);
    const double slack = kRounding * (1 + std::abs(velocity));
    const double low = std::min(velocity, 0.0) - slack;
    const double high = std::max(velocity, 0.0) + slack;
    const bool is_monotone = range.least.value >= low && range.greatest.value <= high;
    measures_.not_monotone += is_monotone ? 0U : 1U;
    const bool is_short = distance <= std::abs(velocity) * length / 2 + slack;
    measures_.too_far += is_short ? 0U : 1U;
    const double true_velocity = motion_.at(joint, t, 1);
    measures_.velocity_errors.push_back(std::abs(velocity - true_velocity));
    measures_.runs_on.push_back(std::max(0.0, distance - std::abs(true_velocity) * length / 2));
    measures_.stop_acceleration = std::max(measures_.stop_acceleration, stop.largest(joint, 2));
    measures_.stop_jerk = std::max(measures_.stop_jerk, stop.largest(joint, 3));
  }

  void look_at_last(const Look& last, std::size_t joint) {
    constexpr int kPieces = 16;
    const double from = seconds_at(last.segment.left);
    double error = 0;
    double low = motion_.at(joint, from);
    double high = low;
    for (int i = 0; i <= kPieces; ++i) {
      const double u = last.seconds() * i / kPieces;
      const double truth = motion_.at(joint, from + u);
      low = std::min(low, truth);
      high = std::max(high, truth);
      error = std::max(error, std::abs(last.at(joint, u, 0) - truth));
    }
    const auto range = last.range(joint, 0);
    measures_.last_path_errors.push_back(error);
    measures_.overshoot =
        std::max({measures_.overshoot, range.greatest.value - high, low - range.least.value});
    measures_.last_acceleration = std::max(measures_.last_acceleration, last.largest(joint, 2));
  }

  const Sines& motion_;
  StopMeasures& measures_;
};

TrialOptions options_of(const Data& data, const Curve& curve) {
  return {.window = curve.window, .quantum = data.quantum};
}

/// Copies the two newest published segments.
bool take_newest(Trial& trial, ipc::BoardSnapshot& out) {
  const Time newest = trial.summary().newest_time;
  return has_values(trial.sampler().snapshot(newest - Time(1), newest, out));
}

}  // namespace

StopMeasures measure_stops(const Sines& motion, const Data& data, const Curve& curve) {
  StopMeasures measures;
  Measuring measuring(motion, measures);
  const Schedule schedule = schedule_of(motion, data, Sines::kSeconds);
  TrialOptions options = options_of(data, curve);
  options.watch = [&](const Sight& sight) {
    if (sight.t >= kMeasured) measuring.read(sight);
  };
  Trial trial(motion, schedule, std::move(options));
  ipc::BoardSnapshot newest(Sines::kJoints);
  while (trial.now() < Sines::kSeconds - 2 * kLead) {
    trial.tick();
    if (trial.now() >= kMeasured && take_newest(trial, newest)) measuring.look(newest.segments());
  }
  for (auto* values : {&measures.velocity_errors, &measures.runs_on, &measures.last_path_errors}) {
    std::ranges::sort(*values);
  }
  return measures;
}

double cut_off(const Sines& motion, const Data& data, const Curve& curve, double cut) {
  constexpr double kAtRest = 0.5;  // s, after which a stop has ended
  const Schedule schedule = schedule_of(motion, data, cut);
  std::vector<double> rest;
  TrialOptions options = options_of(data, curve);
  options.watch = [&](const Sight& sight) {
    rest.assign(sight.state->position().begin(), sight.state->position().end());
  };
  Trial trial(motion, schedule, std::move(options));
  ipc::BoardSnapshot newest(Sines::kJoints);
  while (trial.now() < cut) trial.tick();
  const bool is_stop = take_newest(trial, newest) && !newest.segments().empty() &&
                       newest.segments().back().kind == SegmentKind::stop;
  if (!is_stop) return 0;
  const Look stop{newest.segments().back(), Sines::kJoints};
  while (trial.now() < cut + kAtRest) trial.tick();
  double distance = 0;
  for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
    distance = std::max(distance, std::abs(rest[joint] - stop.at(joint, stop.seconds(), 0)));
  }
  return distance;
}

}  // namespace splinecast::campaign
