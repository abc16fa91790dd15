#include "tests/campaign/motions/recorded.hpp"

#include <algorithm>
#include <cmath>

#include "apps/files/polynomial_file.hpp"
#include "apps/tables/waypoints.hpp"
#include "core/limits/extremes.hpp"
#include "splinecast/fit.hpp"

namespace splinecast::campaign {

Recorded Recorded::from_waypoints(const std::filesystem::path& file,
                                  const std::vector<std::string>& columns) {
  const auto table = apps::read_waypoints(file, {.columns = columns});
  std::vector<Time> times;
  std::vector<double> positions;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Time t = table.times[i] - table.times[0];
    if (!times.empty() && t <= times.back()) continue;
    times.push_back(t);
    const auto position = table.waypoint(i).position;
    positions.insert(positions.end(), position.begin(), position.end());
  }
  return {columns.size(), std::move(times), positions};
}

Recorded Recorded::from_polynomials(const std::filesystem::path& file) {
  constexpr Time kInterval{10'000'000};
  const auto polynomials = apps::read_polynomials(file);
  const std::size_t dimensions = polynomials.names.size();
  std::vector<Time> times;
  std::vector<double> positions;
  for (Time t{}; t <= polynomials.curve.breaks().back(); t += kInterval) {
    times.push_back(t);
    positions.resize(times.size() * dimensions);
    polynomials.curve.derivative(t, 0, std::span(positions).last(dimensions));
  }
  return {dimensions, std::move(times), positions};
}

Recorded::Recorded(std::size_t dimensions, std::vector<Time> times,
                   const std::vector<double>& positions)
    : curve_(fit({.dimensions = dimensions, .times = times, .positions = positions}, {})) {}

double Recorded::seconds() const noexcept { return to_seconds(curve_.breaks().back()); }

double Recorded::at(std::size_t joint, double t, int derivative) const {
  std::vector<double> values(joints());
  const Time last = curve_.breaks().back();
  curve_.derivative(std::clamp(Time(std::llround(t * 1e9)), Time{}, last), derivative, values);
  return values[joint];
}

double Recorded::peak(std::size_t joint, int derivative) const {
  double most = 0;
  for (std::size_t i = 0; i < curve_.segments(); ++i) {
    const auto range = core::range_of(curve_.order_of(i), curve_.coefficients(i), joints(), joint,
                                      derivative, 0, curve_.seconds(i));
    most = std::max(most, std::abs(range.largest().value));
  }
  return most;
}

Schedule Recorded::schedule(double lead, std::vector<std::pair<double, double>> gaps) const {
  Schedule schedule;
  for (const Time time : curve_.breaks()) {
    const double t = to_seconds(time);
    const auto lacks = [&](const auto& gap) { return t >= gap.first && t < gap.second; };
    if (std::ranges::any_of(gaps, lacks)) continue;
    schedule.calls.push_back({.at = t - lead, .times = {t}, .positions = {positions(t)}});
  }
  schedule.pauses = std::move(gaps);
  return schedule;
}

}  // namespace splinecast::campaign
