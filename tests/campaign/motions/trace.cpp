#include "tests/campaign/motions/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/output/stream.hpp"
#include "apps/streams/report.hpp"

namespace splinecast::campaign {
namespace {

constexpr double kBefore = 0.3;               ///< s shown before the fault
constexpr double kLongest = 4;                ///< s, longest time shown
constexpr double kOnPath = 2e-4;              ///< rad: largest path error on the path
constexpr double kCalm = 0.08;                ///< s on the path after which a fault is over
constexpr double kStarted = 1.9;              ///< s: faults are searched from here on
constexpr double kEnd = Sines::kSeconds - 1;  ///< s: faults are searched up to here
constexpr double kTick = 1e-3;                ///< s

/// A stored sample.
struct Row {
  double t = 0;
  SampleStatus status{};
  SegmentKind kind{};
  std::uint64_t starvations = 0;
  State state{Sines::kJoints};
  double error = 0;  ///< rad, the largest of all joints; 0 before 0 s
};

double error_of(const Row& row, const Motion& motion, const Schedule& schedule, std::size_t joint) {
  if (row.t < 0) return 0;
  return std::abs(row.state.position()[joint] - motion.at(joint, row.t) - schedule.offset(row.t));
}

bool is_at_rest(const Row& row) {
  return row.status == SampleStatus::stopping || row.status == SampleStatus::holding;
}

/// The time of the first starvation; without one, of the first replacement; without both, 0.
double fault_of(const std::vector<Row>& rows, const Schedule& schedule) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const bool is_measured = rows[i].t >= kStarted && rows[i].t < kEnd;
    if (is_measured && rows[i].starvations > rows[i - 1].starvations) return rows[i].t;
  }
  for (const Call& call : schedule.calls) {
    if (call.at >= kStarted && call.replaces_from) return call.at;
  }
  return 0;
}

struct Window {
  double fault = 0;
  std::size_t first = 0;
  std::size_t end = 0;
  double back = 0;  ///< s from the fault until the path is reached; −1: not within the window
};

Window window_of(const std::vector<Row>& rows, const Schedule& schedule) {
  Window window{.fault = fault_of(rows, schedule), .end = rows.size(), .back = -1};
  double calm_since = -1;
  bool has_left = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.t < window.fault - kBefore) window.first = i + 1;
    if (row.t < window.fault) continue;
    const bool is_off = row.kind == SegmentKind::entry || is_at_rest(row) || row.error > kOnPath;
    has_left = has_left || is_off;
    if (is_off) calm_since = -1;
    if (!is_off && calm_since < 0) calm_since = row.t;
    const bool is_calm = has_left && calm_since >= 0 && row.t >= calm_since + kCalm;
    if (is_calm && window.back < 0) window.back = calm_since - window.fault;
    const bool is_whole = is_calm && schedule.deaths.empty();  // the window shows later deaths too
    if (is_whole || row.t >= window.fault - kBefore + kLongest) {
      window.end = i;
      break;
    }
  }
  return window;
}

std::size_t worst_joint(std::span<const Row> rows, const Motion& motion, const Schedule& schedule) {
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
    for (const Row& row : rows) {
      const double error = error_of(row, motion, schedule, joint);
      if (error > most) {
        most = error;
        worst = joint;
      }
    }
  }
  return worst;
}

std::string_view status_of(const Row& row) {
  if (row.kind == SegmentKind::entry) return "entry";
  if (row.kind == SegmentKind::slowed) return "slowed";
  return row.kind == SegmentKind::stop ? "stopping" : to_string(row.status);
}

std::string csv_of(std::span<const Row> rows, const Motion& motion, const Schedule& schedule,
                   std::size_t joint) {
  std::string text =
      "t [s],target position [rad],target velocity [rad/s],position [rad],velocity [rad/s],"
      "acceleration [rad/s2],status\n";
  const auto to = std::back_inserter(text);
  for (const Row& row : rows) {
    fmt::format_to(to, "{:.3f},", row.t);
    if (row.t >= 0) {
      fmt::format_to(to, "{:.6f},{:.6f}", motion.at(joint, row.t) + schedule.offset(row.t),
                     motion.at(joint, row.t, 1));
    } else {
      text += ',';
    }
    fmt::format_to(to, ",{:.6f},{:.6f},{:.6f},{}\n", row.state.position()[joint],
                   row.state.velocity()[joint], row.state.acceleration()[joint], status_of(row));
  }
  return text;
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  apps::Output output(path);
  output.write(text);
  output.close();
}

/// Duration in s of the samples for which `holds` is true.
double seconds_of(std::span<const Row> rows, const auto& holds) {
  return kTick * static_cast<double>(std::ranges::count_if(rows, holds));
}

double largest_error(std::span<const Row> rows) {
  double most = 0;
  for (const Row& row : rows) most = std::max(most, row.error);
  return most;
}

/// The intervals that begin within the samples.
nlohmann::json within(std::span<const std::pair<double, double>> intervals,
                      std::span<const Row> rows) {
  nlohmann::json kept = nlohmann::json::array();
  for (const auto& [from, until] : intervals) {
    if (from >= rows.front().t && from <= rows.back().t) kept.push_back({from, until});
  }
  return kept;
}

nlohmann::json replacements_within(const Schedule& schedule, std::span<const Row> rows) {
  std::vector<std::pair<double, double>> found;
  for (const Call& call : schedule.calls) {
    if (call.replaces_from) found.emplace_back(call.at, *call.replaces_from);
  }
  return within(found, rows);
}

/// Durations of the states of the curve in the samples, and the largest path error.
nlohmann::json shown_json(std::span<const Row> shown) {
  const auto is_stopping = [](const Row& row) { return row.status == SampleStatus::stopping; };
  const auto is_holding = [](const Row& row) { return row.status == SampleStatus::holding; };
  const auto is_entry = [](const Row& row) { return row.kind == SegmentKind::entry; };
  return {{"stopping [s]", seconds_of(shown, is_stopping)},
          {"holding [s]", seconds_of(shown, is_holding)},
          {"in entries [s]", seconds_of(shown, is_entry)},
          {"largest path error shown [rad]", largest_error(shown)}};
}

/// Results of a whole trial.
nlohmann::json seen_json(const Seen& seen) {
  return {{"largest path error [rad]", seen.error(1)},
          {"path error p99 [rad]", seen.error(0.99)},
          {"peak velocity [rad/s]", seen.peak_velocity()},
          {"peak acceleration [rad/s2]", seen.peak_acceleration()},
          {"peak acceleration in entries [rad/s2]", seen.entry_acceleration},
          {"waypoints", seen.knots},
          {"passed over", seen.passed_over},
          {"refused as past", seen.past},
          {"refused for other reasons", seen.refused},
          {"starvations", seen.starvations},
          {"holding outside the pauses [%]", 100 * seen.holding}};
}

/// The joint that is fastest shortly before the last waypoint; with a wall, the one that has it.
std::size_t shown_joint(const Motion& motion, const Ended& ended) {
  constexpr double kShortly = 0.5;
  std::size_t joint = 0;
  const auto speed = [&](std::size_t i) {
    return std::abs(motion.at(i, EndedMotion::kEnd - kShortly, 1));
  };
  for (std::size_t d = 1; ended.wall == 0 && d < Sines::kJoints; ++d) {
    if (speed(d) > speed(joint)) joint = d;
  }
  return joint;
}

bool moves(const Row& row) {
  return std::ranges::any_of(row.state.velocity(), [](double v) { return v != 0; });
}

/// How far the worst joint rests from the last waypoint.
double distance_from_last(const Row& row, const Motion& motion) {
  double most = 0;
  for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
    const double last = motion.at(joint, EndedMotion::kEnd);
    most = std::max(most, std::abs(row.state.position()[joint] - last));
  }
  return most;
}

double peak_of(std::span<const Row> rows, int derivative) {
  double most = 0;
  for (const Row& row : rows) {
    for (const double value : derivative == 1 ? row.state.velocity() : row.state.acceleration()) {
      most = std::max(most, std::abs(value));
    }
  }
  return most;
}

}  // namespace

Traces::Traces(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::filesystem::create_directories(folder_ / "ends");
}

void Traces::add(const Sines& motion, const Fault& fault, double limit, TrialOptions options) {
  const Schedule schedule = fault.make(motion, options.seed);
  std::vector<Row> rows;
  options.watch = [&](const Sight& sight) {
    Row row{.t = sight.t,
            .status = sight.status,
            .kind = sight.kind,
            .starvations = sight.starvations,
            .state = *sight.state};
    for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
      row.error = std::max(row.error, error_of(row, motion, schedule, joint));
    }
    rows.push_back(std::move(row));
  };
  const Seen seen = Trial(motion, schedule, options).run();
  const Window window = window_of(rows, schedule);
  const auto shown = std::span(rows).subspan(window.first, window.end - window.first);
  const std::size_t joint = worst_joint(shown, motion, schedule);
  const std::string name = fmt::format("{}_{}", fault.file, limit > 0 ? "limit" : "no_limit");
  write_file(folder_ / (name + ".csv"), csv_of(shown, motion, schedule, joint));
  nlohmann::json row{{"file", name},
                     {"fault", fault.name},
                     {"section", fault.file},
                     {"limit [rad/s2]", limit},
                     {"joint", joint + 1},
                     {"fault at [s]", window.fault},
                     {"silences [s]", within(schedule.pauses, shown)},
                     {"solver dead [s]", within(schedule.deaths, shown)},
                     {"replacements [s]", replacements_within(schedule, shown)},
                     {"back on the path after [s]", window.back}};
  row.update(shown_json(shown));
  row.update(seen_json(seen));
  rows_.push_back(std::move(row));
}

void Traces::add(const Sines& motion, const Ended& ended, double limit, TrialOptions options) {
  constexpr double kShownBefore = 0.5;  // s before the last waypoint
  constexpr double kShownAfter = 0.15;  // s at rest
  const EndedMotion own(motion, ended.eases);
  const Schedule schedule = ended.schedule(own);
  options.window.limits = ended.limits(own, limit);
  std::vector<Row> rows;
  options.watch = [&](const Sight& sight) {
    if (sight.t < EndedMotion::kEnd - kShownBefore) return;
    rows.push_back(
        {.t = sight.t, .status = sight.status, .kind = sight.kind, .state = *sight.state});
  };
  Trial trial(own, schedule, options);
  (void)trial.run();
  const auto last = std::ranges::find_if(rows.rbegin(), rows.rend(), moves);
  const double rest = last != rows.rend() ? last->t : EndedMotion::kEnd;
  std::erase_if(rows, [&](const Row& row) { return row.t > rest + kShownAfter; });
  const std::size_t joint = shown_joint(own, ended);
  const ipc::Summary& summary = trial.summary();
  const std::string name = fmt::format("{}_{}", ended.file, limit > 0 ? "limit" : "no_limit");
  write_file(folder_ / (name + ".csv"), csv_of(rows, own, schedule, joint));
  rows_.push_back({{"file", name},
                   {"fault", ended.name},
                   {"section", ended.file},
                   {"limit [rad/s2]", limit},
                   {"joint", joint + 1},
                   {"silences [s]", nlohmann::json::array()},
                   {"solver dead [s]", nlohmann::json::array()},
                   {"replacements [s]", nlohmann::json::array()},
                   {"finish at [s]", *schedule.finish_at},
                   {"end", apps::to_string(summary.ending())},
                   {"rest after the last waypoint [s]", rest - EndedMotion::kEnd},
                   {"rest from the last waypoint [rad]", distance_from_last(rows.back(), own)},
                   {"peak acceleration [rad/s2]", peak_of(rows, 2)},
                   {"peak velocity [rad/s]", peak_of(rows, 1)},
                   {"passed over", summary.passed_over},
                   {"excesses", summary.exceeding}});
}

void Traces::finish() const { write_file(folder_ / "rows.json", rows_.dump(1) + "\n"); }

}  // namespace splinecast::campaign
