#include "apps/fit/executed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <string_view>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/record/executed/events.hpp"
#include "apps/record/executed/exact_messages.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps {
namespace {

/// The stream that a topic names: `arm`, `/arm/waypoints`, `/arm/splinecast`.
std::string stream_of(std::string_view topic) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  return std::string(topic.substr(0, topic.find('/')));
}

/// The only stream of a file.
std::string only_stream(const std::string& file) {
  const auto streams = record::executed_streams(file);
  if (streams.size() == 1) return streams.front();
  std::string list;
  for (const std::string& name : streams) list += fmt::format("\n  {}", ipc::printable(name));
  throw InputError(streams.empty()
                       ? fmt::format("{}: it has no executed curve, because no stream in it had a "
                                     "solver: --waypoints takes the waypoints",
                                     ipc::printable(file))
                       : fmt::format("{}: choose one of its streams with --topic:{}",
                                     ipc::printable(file), list));
}

Waypoints view_of(const ReportPoints& points, std::size_t dimensions) {
  return {.dimensions = dimensions,
          .times = points.times,
          .positions = points.positions,
          .velocities = {},
          .accelerations = {}};
}

void add(Time time, std::span<const double> position, ReportPoints& points) {
  points.times.push_back(time);
  points.positions.insert(points.positions.end(), position.begin(), position.end());
}

/// The waypoints on the curve, at the left ends of segments and at the end.
ReportPoints met_waypoints(const record::ExecutedStream& stream) {
  ReportPoints met;
  for (const ipc::SegmentCopy& segment : stream.curve.segments()) {
    if (segment.has_waypoint) add(segment.left, segment.waypoint, met);
  }
  const auto segments = stream.curve.segments();
  if (segments.empty() || !segments.back().origin.ends_at_waypoint) return met;
  for (const record::SentWaypoint& sent : stream.waypoints) {
    if (sent.time == segments.back().right && !sent.is_refused) add(sent.time, sent.position, met);
  }
  return met;
}

/// Those that the curve does not meet, as far as the file has the curve.
ReportPoints missed_waypoints(const record::ExecutedStream& stream, const ReportPoints& met,
                              Time until) {
  const std::set<Time> times(met.times.begin(), met.times.end());
  ReportPoints missed;
  for (const record::SentWaypoint& sent : stream.waypoints) {
    if (sent.time <= until && !times.contains(sent.time)) add(sent.time, sent.position, missed);
  }
  return missed;
}

/// The segments of other kinds than the spline, and the gaps.
std::vector<ReportSpan> spans_of(const record::ExecutedStream& stream) {
  std::vector<ReportSpan> spans;
  const auto add_span = [&](Time from, Time to, std::string_view kind) {
    const bool continues = !spans.empty() && spans.back().to == from && spans.back().kind == kind;
    if (!continues) spans.push_back({.from = from, .to = to, .kind = std::string(kind)});
    spans.back().to = to;
  };
  const ipc::SegmentCopy* before = nullptr;
  for (const ipc::SegmentCopy& segment : stream.curve.segments()) {
    if (before != nullptr && before->right != segment.left) {
      add_span(before->right, segment.left, "missing");
    }
    if (segment.kind != SegmentKind::spline) {
      add_span(segment.left, segment.right, record::to_string(segment.kind));
    }
    before = &segment;
  }
  const ipc::OpenSegment* const open = stream.curve.open();
  if (open != nullptr && open->segment.kind != SegmentKind::spline) {
    add_span(open->segment.left, open->until, record::to_string(open->segment.kind));
  }
  return spans;
}

/// The events of the recording, and the waypoints that came late.
std::vector<ReportMark> marks_of(const record::ExecutedStream& stream, const std::string& path) {
  constexpr Time kLeastLate = std::chrono::milliseconds(1);  // the interval of the recorder's looks
  std::vector<ReportMark> marks;
  for (auto& event : record::read_events(path, stream.curve.options().stream)) {
    marks.push_back({.time = event.time, .text = std::move(event.text)});
  }
  if (marks.size() == record::kMostEvents) {
    marks.push_back({.time = marks.back().time,
                     .text = fmt::format("only the first {} events are listed", marks.size())});
  }
  for (const record::SentWaypoint& sent : stream.waypoints) {
    if (sent.is_refused || sent.late <= kLeastLate) continue;
    marks.push_back({.time = sent.time,
                     .text = fmt::format("waypoint {} came {:.6g} ms late", sent.item,
                                         1e3 * to_seconds(sent.late))});
  }
  std::ranges::stable_sort(marks, {}, &ReportMark::time);
  return marks;
}

}  // namespace

void add_waypoints(Command& verb, bool& waypoints) {
  verb.flag("--waypoints", waypoints,
            "Of a recording that 'record' wrote: fit its waypoints (default: the executed curve)");
}

bool uses_executed(const Command& verb, const std::string& file, bool waypoints,
                   const std::vector<std::string>& allowed) {
  if (waypoints || !record::is_recording(file)) return false;
  for (const std::string& name : verb.given()) {
    if (std::ranges::find(allowed, name) != allowed.end()) continue;
    throw UsageError(name,
                     "the file is a recording, of which the executed curve is taken; this "
                     "goes with its waypoints: add --waypoints");
  }
  return true;
}

std::vector<std::string> Executed::names() const {
  return ipc::dimension_names(stream.curve.header());
}

std::vector<std::string> Executed::columns() const {
  std::vector<std::string> columns = names();
  const auto units = ipc::dimension_units(stream.curve.header());
  for (std::size_t d = 0; d < columns.size(); ++d) {
    if (!units[d].empty()) columns[d] += fmt::format(" [{}]", units[d]);
  }
  return columns;
}

std::vector<Dimension> Executed::kinds() const { return ipc::dimensions_of(stream.curve.header()); }

MotionLimits Executed::limits() const { return ipc::motion_limits(stream.curve.header()); }

Executed read_executed_curve(const std::string& file, const TableOptions& table) {
  const std::string name = table.topic.empty() ? only_stream(file) : stream_of(table.topic);
  record::ExecutedStream stream = record::read_executed(file, name);
  auto parts = stream.curve.parts();
  if (parts.empty()) {
    throw InputError(
        fmt::format("{}: stream '{}' has no settled segment: --waypoints takes its "
                    "waypoints",
                    stream.file, name));
  }
  record::say_what_is_missing(stream);
  if (!table.quiet) {
    const bool has_law = stream.curve.header().law_id != 0;
    say(fmt::format("{}: '{}': the executed curve, {} segments{}", stream.file, name,
                    stream.curve.segments().size(), has_law ? ", in stream time" : ""));
  }
  return {.stream = std::move(stream), .parts = std::move(parts)};
}

Report report_of(const Executed& executed, const std::string& path) {
  Report report{
      .title = fmt::format("{}: {}", executed.stream.file, executed.stream.curve.options().stream),
      .names = executed.names(),
      .units = ipc::dimension_units(executed.stream.curve.header()),
      .waypoints = {},
      .kinds = executed.kinds(),
      .curves = {}};
  for (const PiecewisePolynomial& part : executed.parts) {
    const bool is_only = executed.parts.size() == 1;
    report.curves.push_back(
        {.name = is_only ? "executed" : fmt::format("executed, part {}", report.curves.size() + 1),
         .curve = part});
  }
  report.met = met_waypoints(executed.stream);
  report.waypoints = view_of(report.met, report.names.size());
  report.missed =
      missed_waypoints(executed.stream, report.met, executed.parts.back().breaks().back());
  report.spans = spans_of(executed.stream);
  report.marks = marks_of(executed.stream, path);
  report.limits = executed.limits();
  return report;
}

}  // namespace splinecast::apps
