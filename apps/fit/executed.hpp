#pragma once

#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/fit/report_page.hpp"
#include "apps/record/executed/executed_file.hpp"
#include "apps/tables/options.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/piecewise_polynomial.hpp"

/// The executed curve of a recording, for the verbs that otherwise fit a curve to waypoints.
namespace splinecast::apps {

/// Adds `--waypoints`.
void add_waypoints(Command& verb, bool& waypoints);

/// Whether a verb uses the executed curve: the file is a recording, and its waypoints are not asked
/// for. Throws UsageError if an option is given that is not in `allowed` and belongs to waypoints.
[[nodiscard]] bool uses_executed(const Command& verb, const std::string& file, bool waypoints,
                                 const std::vector<std::string>& allowed);

/// An executed curve in stream time.
struct Executed {
  record::ExecutedStream stream;
  std::vector<PiecewisePolynomial> parts;  ///< without gaps; at least one

  [[nodiscard]] std::vector<std::string> names() const;
  /// The names with their units, as columns have them: `x [m]`.
  [[nodiscard]] std::vector<std::string> columns() const;
  [[nodiscard]] std::vector<Dimension> kinds() const;
  /// Those of the stream.
  [[nodiscard]] MotionLimits limits() const;
};

/// Reads the curve of the stream that `table.topic` names, or of the only stream of the file.
/// Prints which curve was taken, if not `table.quiet`. Throws InputError if the file does not have
/// it.
[[nodiscard]] Executed read_executed_curve(const std::string& file, const TableOptions& table);

/// What a report shows of it: the parts, the waypoints that it meets and those that it does not,
/// entries, stops and holds, limits, and the events of the recording.
[[nodiscard]] Report report_of(const Executed& executed, const std::string& path);

}  // namespace splinecast::apps
