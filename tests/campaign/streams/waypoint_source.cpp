#include "tests/campaign/streams/waypoint_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace splinecast::campaign {
namespace {

/// Probabilities that a waypoint lacks derivatives, or a quaternion is 0 or not of unit length.
constexpr double kLacksDerivatives = 0.02;
constexpr double kZeroQuaternion = 0.005;
constexpr double kOtherLength = 0.05;

}  // namespace

WaypointSource::WaypointSource(const StreamPlan& plan, Random& random)
    : plan_(&plan),
      random_(&random),
      position_(plan.dimensions.size()),
      velocity_(plan.dimensions.size()),
      acceleration_(plan.dimensions.size()) {
  for (const Dimension& dimension : plan.dimensions) {
    Wave wave{.amplitude = plan.magnitude * random.uniform(0.2, 1),
              .frequency = plan.frequency * random.uniform(0.5, 1),
              .phase = random.uniform(0, 6.28),
              .offset = plan.offset * plan.magnitude};
    if (dimension.kind == DimensionKind::periodic) {
      wave.amplitude = dimension.period * random.uniform(0.1, 3);
      wave.offset = dimension.period * random.uniform(-2, 2);
    } else if (dimension.kind >= DimensionKind::quaternion) {
      wave.amplitude = random.uniform(0.1, 3);
      wave.offset = 0;
    }
    waves_.push_back(wave);
  }
}

void WaypointSource::change_mode() {
  constexpr std::array kModes{Mode::smooth, Mode::smooth, Mode::quantised, Mode::repeated,
                              Mode::noisy};
  mode_ = kModes[random_->below(kModes.size())];
  grid_ = random_->log_uniform(1e-3, 1);
}

WaypointSource::Values WaypointSource::wave_at(const Wave& wave, double s) {
  const double angle = wave.frequency * s + wave.phase;
  const double v = wave.amplitude * wave.frequency;
  return {.x = wave.offset + wave.amplitude * std::sin(angle),
          .v = v * std::cos(angle),
          .a = -v * wave.frequency * std::sin(angle)};
}

Waypoint WaypointSource::view(Time t, bool with_derivatives) const {
  Waypoint waypoint{.time = t, .position = position_};
  if (!with_derivatives) return waypoint;
  waypoint.velocity = velocity_;
  waypoint.acceleration = acceleration_;
  return waypoint;
}

Waypoint WaypointSource::smooth_at(Time t) {
  write_motion(t);
  return view(t, true);
}

Waypoint WaypointSource::at(Time t) {
  if (mode_ == Mode::repeated) {
    std::ranges::fill(velocity_, 0.0);
    std::ranges::fill(acceleration_, 0.0);
    if (std::ranges::all_of(position_, [](double x) { return x == 0; })) write_motion(t);
  } else {
    write_motion(t);
    spoil();
  }
  const bool needs = plan_->window.interpolant.method->needs_velocity();
  return view(t, needs ? !random_->chance(kLacksDerivatives) : random_->chance(0.1));
}

void WaypointSource::write_motion(Time t) {
  const double s = to_seconds(t - plan_->begin);
  for (std::size_t d = 0; d < waves_.size(); ++d) {
    const Values values = wave_at(waves_[d], s);
    if (plan_->dimensions[d].kind >= DimensionKind::quaternion) {
      write_quaternion(d, values);
      d += kQuaternionSize - 1;
      continue;
    }
    position_[d] = values.x;
    velocity_[d] = values.v;
    acceleration_[d] = values.a;
  }
}

/// A rotation by an angle about an axis in the x-y plane.
void WaypointSource::write_quaternion(std::size_t d, const Values& angle) {
  const double sine = std::sin(angle.x / 2);
  const double cosine = std::cos(angle.x / 2);
  const double rate = angle.v / 2;
  const double axis = 0.6;
  const std::array factors{axis, 0.8, 0.0};
  const bool w_first = plan_->dimensions[d].kind == DimensionKind::quaternion_wxyz;
  const std::size_t w = w_first ? d : d + 3;
  const std::size_t first = w_first ? d + 1 : d;
  const double bend = angle.a / 2;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    position_[first + k] = factors[k] * sine;
    velocity_[first + k] = factors[k] * cosine * rate;
    acceleration_[first + k] = factors[k] * (cosine * bend - sine * rate * rate);
  }
  position_[w] = cosine;
  velocity_[w] = -sine * rate;
  acceleration_[w] = -sine * bend - cosine * rate * rate;
}

/// Changes the smooth motion according to the mode.
void WaypointSource::spoil() {
  for (std::size_t d = 0; d < waves_.size(); ++d) {
    if (plan_->dimensions[d].kind >= DimensionKind::quaternion) {
      const auto turn = std::span(position_).subspan(d, kQuaternionSize);
      double length = random_->chance(0.2) ? -1 : 1;
      if (random_->chance(kOtherLength)) length *= random_->log_uniform(1e-3, 1e3);
      if (random_->chance(kZeroQuaternion)) length = 0;
      for (double& x : turn) x *= length;
      d += kQuaternionSize - 1;
      continue;
    }
    const Wave& wave = waves_[d];
    if (mode_ == Mode::quantised) {
      const double grid = wave.amplitude * grid_;
      position_[d] = std::round(position_[d] / grid) * grid;
    } else if (mode_ == Mode::noisy) {
      position_[d] += wave.amplitude * random_->uniform(-1, 1);
    }
  }
}

}  // namespace splinecast::campaign
