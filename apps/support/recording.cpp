#include "support/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "splinecast/ipc/status.hpp"
#include "support/exit_codes.hpp"

namespace splinecast::apps {
namespace {

std::string value_in_row(const WaypointTable& table, std::size_t i) {
  const core::Waypoint row = table.waypoint(i);
  const std::array<const char*, 3> letters{"", "v of ", "a of "};
  const std::array parts{row.position, row.velocity, row.acceleration};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t d = 0; d < parts[p].size(); ++d) {
      if (core::is_usable(parts[p][d])) continue;
      return fmt::format("column '{}{}': {}", letters[p], table.names[d], parts[p][d]);
    }
  }
  return {};
}

/// Why a row was not accepted, with its line and the offending value.
std::string refusal_message(const WaypointTable& table, std::size_t i, ipc::AppendStatus status,
                            core::Time interval) {
  std::string row = fmt::format("{}: waypoint refused: {}", table.where(i), ipc::to_string(status));
  switch (status) {
    case ipc::AppendStatus::not_finite:
      return fmt::format("{}: {}", row, value_in_row(table, i));
    case ipc::AppendStatus::duplicate:
    case ipc::AppendStatus::out_of_order:
    case ipc::AppendStatus::too_close:
    case ipc::AppendStatus::too_far_apart:
      return fmt::format("{}: time {} ns, {} ns after the waypoint before", row,
                         table.times[i].count(), interval.count());
    default:
      return row;
  }
}

/// What the ring would say to the rows of a table, said before anything is sent.
class RowCheck {
 public:
  RowCheck(const WaypointTable& table, const ipc::IngestLimits& limits)
      : table_(&table), limits_(limits) {}

  /// Judges row i against the last row that passed.
  ipc::AppendStatus judge(std::size_t i) {
    const core::Waypoint row = table_->waypoint(i);
    if (!ipc::is_finite(row.position) || !ipc::is_finite(row.velocity) ||
        !ipc::is_finite(row.acceleration)) {
      return ipc::AppendStatus::not_finite;
    }
    interval_ = row.time - last_;
    if (any_) {
      const auto status = ipc::judge_interval(interval_, limits_);
      if (status != ipc::AppendStatus::accepted) return status;
    }
    any_ = true;
    last_ = row.time;
    return ipc::AppendStatus::accepted;
  }
  [[nodiscard]] core::Time interval() const { return interval_; }

 private:
  const WaypointTable* table_;
  ipc::IngestLimits limits_;
  bool any_ = false;
  core::Time last_{};
  core::Time interval_{};
};

}  // namespace

void select_rows(WaypointTable& table, core::Time from, std::optional<core::Time> duration) {
  const core::Time first = table.times.front() + from;
  const auto is_in = [&](core::Time t) {
    return t >= first && (!duration || t - first <= *duration);
  };
  WaypointTable kept = table.without_rows();
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (is_in(table.times[i])) kept.append_row(table, i);
  }
  if (kept.size() == 0) {
    throw InputError(fmt::format("{}: no waypoint lies within --from and --duration", table.file));
  }
  table = std::move(kept);
}

void change_rate(WaypointTable& table, double rate) {
  if (rate == 1.0) return;
  const core::Time first = table.times.front();
  for (core::Time& t : table.times) {
    t = first + core::Time(std::llround(static_cast<double>((t - first).count()) / rate));
  }
  for (double& v : table.velocities) v *= rate;
  for (double& a : table.accelerations) a *= rate * rate;
}

core::Time median_interval(const WaypointTable& table) {
  std::vector<core::Time> intervals;
  for (std::size_t i = 1; i < table.size(); ++i) {
    intervals.push_back(table.times[i] - table.times[i - 1]);
  }
  if (intervals.empty()) return std::chrono::milliseconds(10);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

void drop_unfit_rows(WaypointTable& table, const ipc::IngestLimits& limits, RefusedRows* skipped) {
  WaypointTable good = table.without_rows();
  RowCheck check(table, limits);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto status = check.judge(i);
    if (status != ipc::AppendStatus::accepted) {
      const std::string message = refusal_message(table, i, status, check.interval());
      if (skipped == nullptr) throw InputError(message);
      skipped->add(
          {.by = RefusedBy::file, .reason = ipc::to_string(status), .line = table.lines[i]},
          message);
      continue;
    }
    good.append_row(table, i);
  }
  if (good.size() == 0) throw InputError(fmt::format("{}: no waypoint can be sent", table.file));
  table = std::move(good);
}

}  // namespace splinecast::apps
