#include "splinecast/core/limits.hpp"

#include <algorithm>
#include <cmath>

#include "splinecast/core/segment_extremes.hpp"

namespace splinecast::core {
namespace {

/// Longest time that limits can ask for, s: beyond it they are out of all proportion.
constexpr double kLongest = 1e6;
/// Shortest time that is distinguished, s: a velocity next to 0 is brought to rest within it.
constexpr double kShortest = 1e-9;
/// Leaves the rounding of a peak out of account.
constexpr double kRounding = 1 + 0x1p-48;

/// Peak acceleration of a stop tail: its own at the start and where its jerk is 0.
double stop_tail_peak(double v, double a, double time) noexcept {
  // a(s) = 6 v/T (s² − s) + a (1 − 4 s + 3 s²), s = u/T.
  const double w = 6 * v / time;
  const double curvature = 2 * (w + 3 * a);
  const double s = curvature == 0 ? 0 : (w + 4 * a) / curvature;
  if (s <= 0 || s >= 1) return std::abs(a);
  return std::max(std::abs(a), std::abs(w * (s * s - s) + a * (1 - 4 * s + 3 * s * s)));
}

/// The number of tries is fixed: arithmetic need not make progress. Without rounding four are
/// enough.
double stop_seconds(double v, double a, double limit) noexcept {
  constexpr double kLonger = 1.1;
  constexpr int kTries = 32;
  const double allowed = std::max(limit, std::abs(a)) * kRounding;
  double time = std::max(1.5 * std::abs(v) / limit, kShortest);
  for (int i = 0; i < kTries && time < kLongest; ++i) {
    if (stop_tail_peak(v, a, time) <= allowed) return time;
    time *= kLonger;
  }
  return kLongest;
}

Time at_least(Time least, double seconds) noexcept {
  constexpr double kNanoseconds = 1e9;
  const double longest = std::min(seconds, kLongest);
  return std::max(least, Time(static_cast<std::int64_t>(std::ceil(longest * kNanoseconds))));
}

}  // namespace

Time stop_time_within(std::span<const double> limits, Time least, std::span<const double> velocity,
                      std::span<const double> acceleration) noexcept {
  double longest = 0;
  for (std::size_t d = 0; d < limits.size(); ++d) {
    if (limits[d] > 0) {
      longest = std::max(longest, stop_seconds(velocity[d], acceleration[d], limits[d]));
    }
  }
  return at_least(least, longest);
}

Time move_time_within(std::span<const double> limits, Time least,
                      std::span<const double> distance) noexcept {
  const double peak = 10 / std::sqrt(3.0);
  double longest = 0;
  for (std::size_t d = 0; d < limits.size(); ++d) {
    if (limits[d] > 0) {
      longest = std::max(longest, std::sqrt(peak * std::abs(distance[d]) / limits[d]));
    }
  }
  return at_least(least, longest);
}

double peak_acceleration(const Segment& segment, std::size_t dimensions, std::size_t d) noexcept {
  const double h = to_seconds(segment.right - segment.left);
  const SegmentRange range = range_of(segment.order, segment.coefficients, dimensions, d, 2, 0, h);
  return std::abs(range.largest().value);
}

double acceleration_excess(std::span<const double> limits, const Segment& segment) noexcept {
  double most = 0;
  for (std::size_t d = 0; d < limits.size(); ++d) {
    if (limits[d] <= 0) continue;
    most = std::max(most, peak_acceleration(segment, limits.size(), d) / limits[d]);
  }
  return most;
}

bool keeps_within(std::span<const double> limits, const Segment& segment) noexcept {
  SegmentPart part = part_of(segment);
  part.dimensions = limits.size();
  for (std::size_t d = 0; d < limits.size(); ++d) {
    if (limits[d] <= 0) continue;
    const double at_start = 2 * std::abs(segment.coefficients[2 * limits.size() + d]);
    const double allowed =
        std::max(limits[d], at_start) + kExtremeRounding * size_of_terms(part, d, 2);
    // Written so that what is no number does not pass.
    if (!(peak_acceleration(segment, limits.size(), d) <= allowed)) return false;
  }
  return true;
}

}  // namespace splinecast::core
