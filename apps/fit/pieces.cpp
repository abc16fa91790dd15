#include "apps/fit/pieces.hpp"

#include <fmt/format.h>

#include "apps/process/exit_codes.hpp"
#include "apps/recordings/recording.hpp"
#include "core/forms/entry.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

void append_all(const PiecewisePolynomial& from, PiecewisePolynomial& to) {
  for (std::size_t i = 0; i < from.segments(); ++i) {
    to.append(from.left_of(i), from.right_of(i), from.order_of(i), from.coefficients(i));
  }
}

/// The segment from rest at the end of a curve to rest at the beginning of the next one.
core::Segment way_between(const PiecewisePolynomial& before, const PiecewisePolynomial& after) {
  State from(before.dimensions());
  State to(before.dimensions());
  before.evaluate(before.breaks().back(), from.ref());
  after.evaluate(after.breaks().front(), to.ref());
  const std::vector<double> rest(before.dimensions());
  core::Segment segment(before.dimensions());
  core::build_entry({.time = before.breaks().back(),
                     .position = from.position(),
                     .velocity = rest,
                     .acceleration = rest},
                    {.time = after.breaks().front(),
                     .position = to.position(),
                     .velocity = rest,
                     .acceleration = rest},
                    segment);
  return segment;
}

}  // namespace

TableGaps find_gaps(const WaypointTable& table, const GapOptions& options) {
  TableGaps found;
  if (options.policy == GapPolicy::bridge) return found;
  std::vector<Time> intervals;
  for (std::size_t i = 1; i < table.size(); ++i) {
    intervals.push_back(table.times[i] - table.times[i - 1]);
  }
  const Time longest = gap_length(options, median_of(intervals));
  for (std::size_t i = 1; i < table.size(); ++i) {
    const Time length = table.times[i] - table.times[i - 1];
    if (length <= longest) continue;
    if (options.policy == GapPolicy::refuse) {
      throw InputError(gap_refusal(table.where(i), length, table.where(i - 1)));
    }
    found.gaps.add({.length = length, .after = table.lines[i - 1], .before = table.lines[i]});
    found.starts.push_back(i);
  }
  return found;
}

WaypointTable part_of(const WaypointTable& table, std::size_t first, std::size_t size) {
  const auto rows = [&](const auto& values, std::size_t width) {
    using Values = std::remove_cvref_t<decltype(values)>;
    if (values.empty()) return Values{};
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first * width);
    return Values(begin, begin + static_cast<std::ptrdiff_t>(size * width));
  };
  WaypointTable part;
  part.file = table.file;
  part.names = table.names;
  part.kinds = table.kinds;
  part.source = table.source;
  part.times = rows(table.times, 1);
  part.lines = rows(table.lines, 1);
  part.positions = rows(table.positions, table.dimensions());
  part.velocities = rows(table.velocities, table.dimensions());
  part.accelerations = rows(table.accelerations, table.dimensions());
  return part;
}

PiecewisePolynomial join(const std::vector<PiecewisePolynomial>& curves) {
  PiecewisePolynomial joined(curves.front().dimensions());
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (i > 0) core::append(way_between(curves[i - 1], curves[i]), joined);
    if (!curves[i].is_hold()) append_all(curves[i], joined);
  }
  return joined;
}

}  // namespace splinecast::apps
