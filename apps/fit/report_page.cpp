#include "apps/fit/report_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/fit/report_rows.hpp"
#include "apps/fit/report_table.hpp"
#include "apps/pages/html_page.hpp"
#include "apps/pages/templates.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostMarks = 4000;  // of waypoints and of knots

/// The contents of the JSON.
struct Measured {
  const Report* report = nullptr;
  Time origin{};
  ReportRows rows;
  std::vector<ReportTable> tables;                 ///< per curve
  std::optional<std::array<double, 3>> intervals;  ///< between waypoints: least, median, greatest
};

double seconds_from(Time origin, Time t) { return to_seconds(t - origin); }

/// nullopt for a single waypoint.
std::optional<std::array<double, 3>> intervals_of(std::span<const Time> times) {
  if (times.size() < 2) return std::nullopt;
  std::vector<Time> h;
  for (std::size_t i = 1; i < times.size(); ++i) h.push_back(times[i] - times[i - 1]);
  std::ranges::sort(h);
  return {{to_seconds(h.front()), to_seconds(h[h.size() / 2]), to_seconds(h.back())}};
}

Measured measure(const Report& report) {
  Measured all;
  all.report = &report;
  all.origin = breaks_of(report.curves).front();
  for (const ReportCurve& curve : report.curves) {
    all.tables.push_back(table_of(curve.curve, report.waypoints, report.kinds));
  }
  all.rows = rows_of(report.curves, all.tables);
  all.intervals = intervals_of(report.waypoints.times);
  return all;
}

/// The largest difference between values of a derivative that rounding alone can cause.
double resolution(const Measured& all, std::size_t d, std::size_t derivative) {
  double size = 0;
  for (const ReportTable& table : all.tables) {
    const Extremes& e = table.rows[d * kDerivatives].extremes;
    size = std::max({size, std::abs(e.least.value), std::abs(e.greatest.value)});
  }
  const double h = all.intervals ? (*all.intervals)[1] : 1;
  return 64 * std::numeric_limits<double>::epsilon() * size /
         std::pow(h, static_cast<double>(derivative));
}

/// Rounds values to a millionth of their range, or of `resolution` if that is larger: a screen
/// shows no more digits.
ordered_json drawn(std::span<const double> values, double resolution) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const double value : values) {
    least = std::fmin(least, value);
    greatest = std::fmax(greatest, value);
  }
  const double digits = 6 - std::floor(std::log10(std::max(greatest - least, resolution)));
  const double unit = std::pow(10, std::abs(digits));
  ordered_json json = ordered_json::array();
  for (const double value : values) {
    const double shown =
        digits < 0 ? std::round(value / unit) * unit : std::round(value * unit) / unit;
    json.push_back(std::isfinite(shown) ? shown : value);
  }
  return json;
}

ordered_json extremum_json(const Measured& all, const Extremum& extremum) {
  return {extremum.value, seconds_from(all.origin, extremum.time)};
}

/// One row of a table; the page adds the texts.
ordered_json row_json(const Measured& all, const ReportRow& row) {
  return {{"least", extremum_json(all, row.extremes.least)},
          {"greatest", extremum_json(all, row.extremes.greatest)},
          {"step", extremum_json(all, row.step)}};
}

ordered_json curve_json(const Measured& all, std::size_t c, std::size_t d) {
  ordered_json values = ordered_json::array();
  ordered_json table = ordered_json::array();
  for (std::size_t r = 0; r < kDerivatives; ++r) {
    values.push_back(
        drawn(all.rows.column(c, all.report->names.size(), d, r), resolution(all, d, r)));
    table.push_back(row_json(all, all.tables[c].rows[d * kDerivatives + r]));
  }
  return {{"values", std::move(values)},
          {"table", std::move(table)},
          {"distance", extremum_json(all, all.tables[c].distance[d])}};
}

/// The step from one marked item to the next, so that at most kMostMarks of `count` are marked.
std::size_t stride(std::size_t count) { return (count + kMostMarks - 1) / kMostMarks; }

ordered_json times_json(std::span<const Time> times, Time origin) {
  ordered_json json = ordered_json::array();
  for (std::size_t i = 0; i < times.size(); i += stride(times.size())) {
    json.push_back(seconds_from(origin, times[i]));
  }
  return json;
}

/// The least and the greatest value of each derivative; null where there is no limit.
ordered_json limits_json(const MotionLimits& limits, std::size_t d) {
  ordered_json json = ordered_json::array();
  const auto bound = [&](const std::vector<double>& bounds) {
    const bool is_there = d < bounds.size() && std::isfinite(bounds[d]);
    return is_there ? ordered_json(bounds[d]) : ordered_json();
  };
  json.push_back({bound(limits.lower), bound(limits.upper)});
  for (const auto* values : {&limits.velocity, &limits.acceleration, &limits.jerk}) {
    const double limit = d < values->size() ? (*values)[d] : 0;
    json.push_back(limit > 0 ? ordered_json{-limit, limit} : ordered_json{nullptr, nullptr});
  }
  return json;
}

ordered_json spans_json(const Measured& all) {
  ordered_json json = ordered_json::array();
  for (const ReportSpan& span : all.report->spans) {
    json.push_back({{"kind", span.kind},
                    {"from", seconds_from(all.origin, span.from)},
                    {"to", seconds_from(all.origin, span.to)}});
  }
  return json;
}

ordered_json marks_json(const Measured& all) {
  ordered_json json = ordered_json::array();
  for (const ReportMark& mark : all.report->marks) {
    json.push_back({{"at", seconds_from(all.origin, mark.time)}, {"text", mark.text}});
  }
  return json;
}

ordered_json dimension_json(const Measured& all, std::size_t d) {
  const Report& report = *all.report;
  ordered_json resolutions = ordered_json::array();
  for (std::size_t r = 0; r < kDerivatives; ++r) resolutions.push_back(resolution(all, d, r));
  ordered_json waypoints = ordered_json::array();
  for (std::size_t i = 0; i < report.waypoints.size(); i += stride(report.waypoints.size())) {
    waypoints.push_back(report.waypoints[i].position[d]);
  }
  ordered_json curves = ordered_json::array();
  for (std::size_t c = 0; c < report.curves.size(); ++c) curves.push_back(curve_json(all, c, d));
  ordered_json missed = ordered_json::array();
  const std::size_t missed_count = report.missed.times.size();
  for (std::size_t i = 0; i < missed_count; i += stride(missed_count)) {
    missed.push_back(report.missed.positions[i * report.names.size() + d]);
  }
  return {{"name", report.names[d]},
          {"unit", report.units[d]},
          {"limits", limits_json(report.limits, d)},
          {"missed", std::move(missed)},
          {"resolution", std::move(resolutions)},
          {"waypoints", std::move(waypoints)},
          {"curves", std::move(curves)}};
}

ordered_json report_json(const Measured& all) {
  const Report& report = *all.report;
  const auto breaks = breaks_of(report.curves);
  ordered_json names = ordered_json::array();
  for (const ReportCurve& curve : report.curves) names.push_back(curve.name);
  ordered_json dimensions = ordered_json::array();
  for (std::size_t d = 0; d < report.names.size(); ++d) {
    dimensions.push_back(dimension_json(all, d));
  }
  return {
      {"title", report.title},
      {"origin_ns", std::to_string(all.origin.count())},  // more digits than a JavaScript number
      {"duration", seconds_from(all.origin, breaks.back())},
      {"count", report.waypoints.size()},
      {"stride", std::max(stride(report.waypoints.size()), stride(breaks.size()))},
      {"intervals", all.intervals ? ordered_json(*all.intervals) : ordered_json()},
      {"bucket", all.rows.bucket},
      {"curves", std::move(names)},
      {"seconds", all.rows.seconds},
      {"waypoint_seconds", times_json(report.waypoints.times, all.origin)},
      {"knot_seconds", times_json(breaks, all.origin)},
      {"missed_seconds", times_json(report.missed.times, all.origin)},
      {"spans", spans_json(all)},
      {"marks", marks_json(all)},
      {"dimensions", std::move(dimensions)}};
}

}  // namespace

void write_report(const Report& report, Output& output) {
  write_page(report_template(), report_json(measure(report)), output);
}

}  // namespace splinecast::apps
