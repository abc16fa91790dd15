#include "apps/recordings/selection.hpp"

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

#include "apps/cli/options.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/kinds.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/status.hpp"

namespace splinecast::apps {
namespace {

std::string value_in_row(const WaypointTable& table, std::size_t i) {
  const Waypoint row = table.waypoint(i);
  const std::array<const char*, 3> letters{"", "v of ", "a of "};
  const std::array parts{row.position, row.velocity, row.acceleration};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t d = 0; d < parts[p].size(); ++d) {
      if (is_usable(parts[p][d])) continue;
      return fmt::format("column '{}{}': {}", letters[p], table.names[d], parts[p][d]);
    }
  }
  return {};
}

bool are_same(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b);
}

/// Decides about each row of a table, in order, before anything is sent.
class RowFilter {
 public:
  RowFilter(WaypointTable& table, const IngestLimits& limits, LatePolicy policy,
            RefusedRows* skipped)
      : table_(&table),
        kinds_(table.kinds),
        limits_(limits),
        policy_(policy),
        skipped_(skipped),
        step_(
            std::max(limits.min_interval, std::min(limits.max_interval, median_interval(table)))) {}

  /// Whether row i is kept after the last kept row. May change its time.
  bool keeps(std::size_t i) {
    auto objection = judge_values(i);
    if (!objection && is_late(i)) {
      count_late(i);
      if (policy_ != LatePolicy::refuse) return keeps_late(i);
    }
    if (!objection) objection = time_refusal(i);
    if (!objection) return keep(i);
    refuse(i, *objection);
    return false;
  }

  [[nodiscard]] const LateRows& late() const { return late_; }

 private:
  /// The reason for which the ring or the solver would refuse a row.
  struct Objection {
    std::string_view reason;
    std::string message;  ///< with the row's line and the offending value
  };

  [[nodiscard]] std::optional<Objection> judge_values(std::size_t i) const {
    const Waypoint row = table_->waypoint(i);
    if (!ipc::is_finite(row.position) || !ipc::is_finite(row.velocity) ||
        !ipc::is_finite(row.acceleration)) {
      return objection(i, AppendStatus::not_finite, value_in_row(*table_, i));
    }
    if (const auto bad = zero_quaternion(*table_, kinds_, i)) {
      return Objection{to_string(Refusal::zero_quaternion),
                       fmt::format("{}: waypoint refused: {}", table_->where(i), *bad)};
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Objection> time_refusal(std::size_t i) const {
    if (kept_ == 0) return std::nullopt;
    const Time time = table_->times[i];
    auto status = ipc::judge_interval(time - last_, limits_);
    if (!is_time_in_range(moved(time))) status = AppendStatus::too_far_apart;
    if (status == AppendStatus::accepted) return std::nullopt;
    return objection(i, status,
                     fmt::format("time {} ns, {} ns after the previous waypoint", time.count(),
                                 (time - last_).count()));
  }

  [[nodiscard]] Objection objection(std::size_t i, AppendStatus status,
                                    const std::string& value) const {
    const std::string_view why = to_string(status);
    return {why, fmt::format("{}: waypoint refused: {}: {}", table_->where(i), why, value)};
  }

  [[nodiscard]] bool is_late(std::size_t i) const { return kept_ > 0 && table_->times[i] <= last_; }

  void count_late(std::size_t i) {
    const Time lateness = last_ - table_->times[i];
    const bool is_duplicate = lateness == Time::zero();
    late_.count(is_duplicate ? &LateRows::duplicate : &LateRows::out_of_order, lateness);
  }

  bool keeps_late(std::size_t i) {
    if (policy_ == LatePolicy::pass || is_copy_of_last(i)) {
      ++late_.left_out;
      return false;
    }
    const Time time = table_->times[i];
    const Time by = saturated_sum(last_ - time, step_);
    if (!is_time_in_range(saturated_sum(moved(time), by))) {
      refuse(i, objection(i, AppendStatus::too_far_apart,
                          fmt::format("time {} ns, to be shifted", time.count())));
      return false;
    }
    late_.shift(by);
    return keep(i);
  }

  [[nodiscard]] bool is_copy_of_last(std::size_t i) const {
    const Waypoint row = table_->waypoint(i);
    const Waypoint last = table_->waypoint(kept_ - 1);
    return table_->times[i] == last_ && are_same(row.position, last.position) &&
           are_same(row.velocity, last.velocity) && are_same(row.acceleration, last.acceleration);
  }

  [[nodiscard]] Time moved(Time time) const { return saturated_sum(time, late_.shifted); }

  bool keep(std::size_t i) {
    last_ = table_->times[i];
    table_->times[i] = moved(last_);
    ++kept_;
    return true;
  }

  void refuse(std::size_t i, const Objection& objection) {
    if (skipped_ == nullptr) throw InputError(objection.message);
    skipped_->add({.by = RefusedBy::file, .reason = objection.reason, .line = table_->lines[i]},
                  objection.message);
  }

  WaypointTable* table_;
  DimensionKinds kinds_;
  IngestLimits limits_;
  LatePolicy policy_;
  RefusedRows* skipped_;
  Time step_;  ///< from the previous row to a row that is shifted
  LateRows late_;
  std::size_t kept_ = 0;
  Time last_{};  ///< recorded time of the last kept row
};

}  // namespace

void select_rows(WaypointTable& table, std::optional<Time> from, std::optional<Time> duration) {
  const Time first = saturated_sum(table.times.front(), from.value_or(Time::zero()));
  const auto is_in = [&](Time t) {
    return (!from || t >= first) && (!duration || t <= saturated_sum(first, *duration));
  };
  table.keep_rows([&](std::size_t i) { return is_in(table.times[i]); });
  if (table.size() == 0) {
    throw InputError(fmt::format("{}: no waypoint is within --from and --duration", table.file));
  }
}

void change_rate(WaypointTable& table, double rate) {
  if (rate == 1.0) return;
  const Time first = table.times.front();
  const double seconds = to_seconds(table.times.back() - first) / rate;
  if (seconds > to_seconds(kLongestTime)) {
    throw InputError(fmt::format("{}: at --rate {} it takes {} s; the maximum is {} s", table.file,
                                 rate, seconds, to_seconds(kLongestTime)));
  }
  for (Time& t : table.times) {
    constexpr double kMost = 9.2e18;  // range of llround; later than any valid time
    const double since = std::min(static_cast<double>((t - first).count()) / rate, kMost);
    t = saturated_sum(first, Time(std::llround(since)));
  }
  for (double& v : table.velocities) v *= rate;
  for (double& a : table.accelerations) a *= rate * rate;
}

Time median_interval(const WaypointTable& table) {
  std::vector<Time> intervals;
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (table.times[i] <= table.times[i - 1]) continue;
    intervals.push_back(table.times[i] - table.times[i - 1]);
  }
  if (intervals.empty()) return std::chrono::milliseconds(10);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

LateRows drop_unfit_rows(WaypointTable& table, const IngestLimits& limits, LatePolicy policy,
                         RefusedRows* skipped) {
  RowFilter filter(table, limits, policy, skipped);
  table.keep_rows([&](std::size_t i) { return filter.keeps(i); });
  if (table.size() == 0) throw InputError(fmt::format("{}: no waypoint can be sent", table.file));
  return filter.late();
}

}  // namespace splinecast::apps
