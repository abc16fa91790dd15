#include "support/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "splinecast/ipc/status.hpp"
#include "support/exit_codes.hpp"
#include "support/kinds.hpp"
#include "support/options.hpp"

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

/// What the ring or the solver would refuse of a table's rows, said before anything is sent.
class RowCheck {
 public:
  struct Objection {
    std::string_view reason;
    std::string message;  ///< with the row's line and the offending value
  };

  RowCheck(const WaypointTable& table, const ipc::IngestLimits& limits)
      : table_(&table), kinds_(table.kinds), limits_(limits) {}

  /// Why row i cannot be sent after the last row that could; nothing if it can.
  std::optional<Objection> judge(std::size_t i) {
    const core::Waypoint row = table_->waypoint(i);
    if (!ipc::is_finite(row.position) || !ipc::is_finite(row.velocity) ||
        !ipc::is_finite(row.acceleration)) {
      return refused(i, ipc::to_string(ipc::AppendStatus::not_finite), value_in_row(*table_, i));
    }
    if (const auto bad = zero_quaternion(*table_, kinds_, i)) {
      return Objection{ipc::to_string(ipc::Refusal::zero_quaternion),
                       fmt::format("{}: waypoint refused: {}", table_->where(i), *bad)};
    }
    const core::Time interval = row.time - last_;
    if (any_) {
      const auto status = ipc::judge_interval(interval, limits_);
      if (status != ipc::AppendStatus::accepted) {
        return refused(i, ipc::to_string(status),
                       fmt::format("time {} ns, {} ns after the waypoint before", row.time.count(),
                                   interval.count()));
      }
    }
    any_ = true;
    last_ = row.time;
    return std::nullopt;
  }

 private:
  [[nodiscard]] Objection refused(std::size_t i, std::string_view why,
                                  const std::string& value) const {
    return {why, fmt::format("{}: waypoint refused: {}: {}", table_->where(i), why, value)};
  }

  const WaypointTable* table_;
  core::DimensionKinds kinds_;
  ipc::IngestLimits limits_;
  bool any_ = false;
  core::Time last_{};
};

}  // namespace

void select_rows(WaypointTable& table, std::optional<core::Time> from,
                 std::optional<core::Time> duration) {
  const core::Time first =
      core::saturated_sum(table.times.front(), from.value_or(core::Time::zero()));
  const auto is_in = [&](core::Time t) {
    return (!from || t >= first) && (!duration || t <= core::saturated_sum(first, *duration));
  };
  table.keep_rows([&](std::size_t i) { return is_in(table.times[i]); });
  if (table.size() == 0) {
    throw InputError(fmt::format("{}: no waypoint lies within --from and --duration", table.file));
  }
}

void change_rate(WaypointTable& table, double rate) {
  if (rate == 1.0) return;
  const core::Time first = table.times.front();
  const double seconds = core::to_seconds(table.times.back() - first) / rate;
  if (seconds > core::to_seconds(kLongestTime)) {
    throw InputError(fmt::format("{}: at --rate {} it takes {} s; the most is {} s", table.file,
                                 rate, seconds, core::to_seconds(kLongestTime)));
  }
  for (core::Time& t : table.times) {
    constexpr double kMost = 9.2e18;  // what llround can return; no stream takes so late a time
    const double since = std::min(static_cast<double>((t - first).count()) / rate, kMost);
    t = core::saturated_sum(first, core::Time(std::llround(since)));
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
  RowCheck check(table, limits);
  table.keep_rows([&](std::size_t i) {
    const auto objection = check.judge(i);
    if (!objection) return true;
    if (skipped == nullptr) throw InputError(objection->message);
    skipped->add({.by = RefusedBy::file, .reason = objection->reason, .line = table.lines[i]},
                 objection->message);
    return false;
  });
  if (table.size() == 0) throw InputError(fmt::format("{}: no waypoint can be sent", table.file));
}

}  // namespace splinecast::apps
