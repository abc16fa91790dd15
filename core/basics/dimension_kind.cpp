#include "splinecast/dimension_kind.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/basics/number_text.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast {
namespace {

using Quaternion = std::array<double, kQuaternionSize>;

constexpr std::string_view kPeriodic = "periodic:";
constexpr std::array<std::pair<DimensionKind, std::string_view>, 3> kKindNames{{
    {DimensionKind::linear, "linear"},
    {DimensionKind::quaternion, "quaternion"},
    {DimensionKind::quaternion_wxyz, "quaternion-wxyz"},
}};

bool is_quaternion(DimensionKind kind) noexcept {
  return kind == DimensionKind::quaternion || kind == DimensionKind::quaternion_wxyz;
}

bool is_period(double period) noexcept {
  return period >= kLeastPeriod && period <= kLargestValue;  // false for NaN
}

double require_period(const Dimension& dimension, std::size_t d) {
  if (is_period(dimension.period)) return dimension.period;
  throw std::invalid_argument("dimension " + std::to_string(d) + " has period " +
                              core::number_text(dimension.period) +
                              ", which is not from 1e-100 to 1e100");
}

Quaternion load(std::span<const double> values, std::size_t first) noexcept {
  Quaternion q{};
  std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), q.size(), q.begin());
  return q;
}

void store(const Quaternion& q, std::span<double> values, std::size_t first) noexcept {
  std::ranges::copy(q, values.begin() + static_cast<std::ptrdiff_t>(first));
}

double dot(const Quaternion& a, const Quaternion& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

bool are_finite(const Quaternion& q) noexcept {
  return std::isfinite(q[0] * 0 + q[1] * 0 + q[2] * 0 + q[3] * 0);
}

void subtract(Quaternion& q, double times, const Quaternion& other) noexcept {
  for (std::size_t k = 0; k < q.size(); ++k) q[k] -= times * other[k];
}

/// Length. Scales by the largest component if squares would overflow or underflow.
double length(const Quaternion& q) noexcept {
  constexpr double kSmall = 1e-200;
  const double square = dot(q, q);
  if (square > kSmall && square < 1 / kSmall) return std::sqrt(square);
  double largest = 0;
  for (const double value : q) largest = std::max(largest, std::abs(value));
  if (!(largest > 0)) return 0;
  Quaternion unit{};
  for (std::size_t k = 0; k < q.size(); ++k) unit[k] = q[k] / largest;
  return largest * std::sqrt(dot(unit, unit));
}

/// Whether a quaternion of this length represents a rotation. It does not if the length is 0, close
/// to 0 or too large; a curve between rotations never has such a length.
bool is_length(double n) noexcept { return n > 1 / kLargestValue && n < kLargestValue; }

/// Divides a quaternion and its derivatives by its length. Returns whether the length is valid.
template <typename... Derivatives>
bool to_unit_length(Quaternion& q, Derivatives&... derivatives) noexcept {
  const double n = length(q);
  if (!is_length(n)) return false;
  const double inverse = 1 / n;  // one division only: every sample calls this
  const auto shorten = [inverse](Quaternion& values) {
    for (double& value : values) value *= inverse;
  };
  shorten(q);
  (shorten(derivatives), ...);
  return true;
}

/// Derivatives of the length m = |r| of a curve r where m = 1, from those of m² = r·r.
struct LengthDerivatives {
  double first;
  double second;
};

/// With r = m·q: r' = q' + m'q and r'' = q'' + 2m'q' + m''q where m = 1. Converts derivatives of r
/// to those of q.
LengthDerivatives keep_unit_length(const Quaternion& q, Quaternion& v, Quaternion& a) noexcept {
  const double m1 = dot(q, v);
  const double m2 = dot(v, v) + dot(q, a) - m1 * m1;
  subtract(v, m1, q);
  subtract(a, 2 * m1, v);
  subtract(a, m2, q);
  return {.first = m1, .second = m2};
}

void normalise_quaternion(const StateRef& state, std::size_t first) noexcept {
  Quaternion q = load(state.position, first);
  Quaternion v = load(state.velocity, first);
  Quaternion a = load(state.acceleration, first);
  Quaternion j = load(state.jerk, first);
  if (!to_unit_length(q, v, a, j)) return;
  const double third = 3 * dot(v, a) + dot(q, j);  // ½(r·r)''', before r' and r'' change
  const auto [m1, m2] = keep_unit_length(q, v, a);
  const double m3 = third - 3 * m1 * m2;
  subtract(j, 3 * m1, a);
  subtract(j, 3 * m2, v);
  subtract(j, m3, q);
  // A derivative is too large for the length. This does not occur on a curve between rotations.
  if (!are_finite(v) || !are_finite(a) || !are_finite(j)) return;
  store(q, state.position, first);
  store(v, state.velocity, first);
  store(a, state.acceleration, first);
  store(j, state.jerk, first);
}

/// 2·vec(q*⊗p), with both quaternions in memory order.
Vector3 body_rate(const Quaternion& q, const Quaternion& p, bool w_first) noexcept {
  const std::size_t v = w_first ? 1 : 0;  // where the vector part begins
  const std::size_t w = w_first ? 0 : 3;
  Vector3 rate{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t k1 = v + (k + 1) % 3;
    const std::size_t k2 = v + (k + 2) % 3;
    rate[k] = 2 * (q[w] * p[v + k] - p[w] * q[v + k] - (q[k1] * p[k2] - q[k2] * p[k1]));
  }
  return rate;
}

}  // namespace

std::string to_string(const Dimension& dimension) {
  if (dimension.kind == DimensionKind::periodic) {
    return std::string(kPeriodic) + core::number_text(dimension.period);
  }
  for (const auto& [kind, name] : kKindNames) {
    if (kind == dimension.kind) return std::string(name);
  }
  return "unknown";
}

std::optional<Dimension> parse_dimension(std::string_view text) {
  for (const auto& [kind, name] : kKindNames) {
    if (name == text) return Dimension{.kind = kind};
  }
  if (!text.starts_with(kPeriodic)) return std::nullopt;
  text.remove_prefix(kPeriodic.size());
  double period = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), period);
  if (error != std::errc{} || end != text.data() + text.size() || !is_period(period)) {
    return std::nullopt;
  }
  return Dimension{.kind = DimensionKind::periodic, .period = period};
}

DimensionKinds::DimensionKinds(std::span<const Dimension> dimensions) {
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    const Dimension& dimension = dimensions[d];
    if (dimension.kind == DimensionKind::periodic) {
      periodic_.push_back({.dimension = d, .period = require_period(dimension, d)});
      continue;
    }
    if (dimension.period != 0) {
      throw std::invalid_argument("dimension " + std::to_string(d) + " has period " +
                                  core::number_text(dimension.period) + " but is not periodic");
    }
    if (!is_quaternion(dimension.kind)) continue;
    const auto rest = dimensions.subspan(d);
    const bool is_whole =
        rest.size() >= kQuaternionSize &&
        std::ranges::all_of(rest.first(kQuaternionSize),
                            [&](const Dimension& other) { return other == dimension; });
    if (!is_whole) {
      throw std::invalid_argument("the quaternion at dimension " + std::to_string(d) +
                                  " does not have four dimensions");
    }
    quaternions_.push_back(
        {.first = d, .w_first = dimension.kind == DimensionKind::quaternion_wxyz});
    d += kQuaternionSize - 1;
  }
}

bool DimensionKinds::takes(std::span<const double> position) const noexcept {
  return std::ranges::all_of(quaternions_, [&](const QuaternionDimensions& quaternion) {
    return takes(position, quaternion);
  });
}

bool DimensionKinds::takes(std::span<const double> position,
                           const QuaternionDimensions& quaternion) noexcept {
  return is_length(length(load(position, quaternion.first)));
}

void DimensionKinds::continue_from(std::span<const double> previous,
                                   const WaypointValues& waypoint) const noexcept {
  for (const auto& [d, period] : periodic_) {
    if (previous.empty()) break;
    const double way = waypoint.position[d] - previous[d];
    // A value that is already near keeps its bits.
    if (std::abs(way) > period / 2) {
      waypoint.position[d] = previous[d] + std::remainder(way, period);
    }
  }
  for (const QuaternionDimensions& quaternion : quaternions_) {
    const std::size_t first = quaternion.first;
    const Quaternion q = load(waypoint.position, first);
    const bool flips = !previous.empty() && dot(q, load(previous, first)) < 0;
    const double divisor = flips ? -length(q) : length(q);
    for (const auto& values : {waypoint.position, waypoint.velocity, waypoint.acceleration}) {
      if (values.empty()) continue;
      for (double& value : values.subspan(first, kQuaternionSize)) value /= divisor;
    }
  }
}

void DimensionKinds::normalise(const StateRef& state) const noexcept {
  for (const auto& [d, period] : periodic_) {
    const double least = std::remainder(state.position[d], period);  // exact; in [−P/2, P/2]
    state.position[d] = least >= period / 2 ? -period / 2 : least;
  }
  for (const QuaternionDimensions& quaternion : quaternions_) {
    normalise_quaternion(state, quaternion.first);
  }
}

void DimensionKinds::normalise_quaternions(std::span<double> position, std::span<double> velocity,
                                           std::span<double> acceleration) const noexcept {
  for (const auto& [first, w_first] : quaternions_) {
    Quaternion q = load(position, first);
    Quaternion v = load(velocity, first);
    Quaternion a = load(acceleration, first);
    if (!to_unit_length(q, v, a)) continue;
    keep_unit_length(q, v, a);
    if (!are_finite(v) || !are_finite(a)) continue;
    store(q, position, first);
    store(v, velocity, first);
    store(a, acceleration, first);
  }
}

void DimensionKinds::normalise_step(std::span<const double> position,
                                    std::span<double> step) const noexcept {
  for (const auto& [first, w_first] : quaternions_) {
    Quaternion q = load(position, first);
    Quaternion s = load(step, first);
    if (!to_unit_length(q, s)) continue;
    // The second derivative of r = q/|q| is r'' = (q'' − (r·q'') r)/|q| + …, where the other terms
    // do not contain q''.
    subtract(s, dot(q, s), q);
    store(s, step, first);
  }
}

void DimensionKinds::require_end(const Condition& end) const {
  if (end.value.empty()) return;
  for (const QuaternionDimensions& quaternion : quaternions_) {
    for (std::size_t d = quaternion.first; d < quaternion.first + kQuaternionSize; ++d) {
      if (d >= end.value.size() || end.value[d] == 0) continue;
      throw std::invalid_argument("end condition '" + to_string(end) + "' has " +
                                  core::number_text(end.value[d]) + " in dimension " +
                                  std::to_string(d) + ", of a quaternion, where only 0 is allowed");
    }
  }
}

AngularMotion angular_motion(const QuaternionDimensions& at, std::span<const double> position,
                             std::span<const double> velocity,
                             std::span<const double> acceleration) noexcept {
  const Quaternion q = load(position, at.first);
  return {.velocity = body_rate(q, load(velocity, at.first), at.w_first),
          .acceleration = body_rate(q, load(acceleration, at.first), at.w_first)};
}

}  // namespace splinecast
