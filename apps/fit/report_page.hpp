#pragma once

#include <string>
#include <vector>

#include "apps/output/stream.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// One of the curves of a report.
struct ReportCurve {
  std::string name;  ///< "c2", "akima", …
  PiecewisePolynomial curve;
};

/// Points of a report that it owns.
struct ReportPoints {
  std::vector<Time> times{};
  std::vector<double> positions{};  ///< [point][dimension]
};

/// A part of the time that a report marks.
struct ReportSpan {
  Time from{};
  Time to{};
  std::string kind;  ///< `entry`, `stop`, `hold`, `slowed`, `missing`
};

/// An instant that a report marks.
struct ReportMark {
  Time time{};
  std::string text;
};

/// What a report shows: curves through, or near, the same waypoints.
struct Report {
  std::string title;
  std::vector<std::string> names;   ///< of the dimensions
  std::vector<std::string> units;   ///< of the positions, one per dimension; "" for an unknown one
  Waypoints waypoints;              ///< at least one, but of an executed curve
  std::vector<Dimension> kinds{};   ///< of the dimensions; empty: all linear
  std::vector<ReportCurve> curves;  ///< at least one, of as many dimensions; none empty
  ReportPoints met{};               ///< the memory of `waypoints`, of an executed curve
  ReportPoints missed{};            ///< waypoints that the curves do not meet
  std::vector<ReportSpan> spans{};  ///< in order, apart
  std::vector<ReportMark> marks{};  ///< in order
  MotionLimits limits{};
};

/// Writes a report as one self-contained HTML file, which needs no network: for each dimension
/// position, velocity, acceleration and jerk over time, all curves in each chart, and a table of
/// extremes, largest steps at knots and distances from the waypoints. Texts may contain any
/// characters. Long recordings are drawn as the least and greatest values of short intervals.
void write_report(const Report& report, Output& output);

}  // namespace splinecast::apps
