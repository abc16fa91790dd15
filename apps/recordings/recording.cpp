#include "apps/recordings/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/kept_rows.hpp"
#include "apps/tables/table_rows.hpp"

namespace splinecast::apps {
namespace {

/// The median interval between the first rows that are in order.
Time measured_median(PreparedRows& rows) {
  std::vector<Time> intervals;
  Row row;
  Time before{};
  for (std::size_t i = 0; i < Recording::kMeasuredRows && rows.next_selected(row); ++i) {
    if (i > 0 && row.time > before) intervals.push_back(row.time - before);
    before = row.time;
  }
  rows.rewind();
  return median_of(intervals);
}

}  // namespace

Time median_of(std::vector<Time>& intervals) {
  if (intervals.empty()) return std::chrono::milliseconds(10);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

Recording::Recording(std::unique_ptr<RowReader> rows, std::vector<Dimension> kinds,
                     const Preparation& how, RefusedRows* refused)
    : rows_(std::make_unique<KeptRows>(std::move(rows))),
      prepared_(*rows_, std::move(kinds), how),
      refused_(refused) {
  prepared_.set_median(measured_median(prepared_));
  look(refused);
}

/// The first pass.
void Recording::look(RefusedRows* refused) {
  std::vector<Time> intervals;
  PreparedRow row;
  Progress progress;
  while (prepared_.next(row, refused)) {
    if (survey_.rows == 0) {
      survey_.first = row.time;
    } else {
      const Time interval = row.time - survey_.last;
      survey_.longest = std::max(survey_.longest, interval);
      if (intervals.size() < kMeasuredRows) intervals.push_back(interval);
    }
    survey_.last = row.time;
    if (++survey_.rows % 65'536 == 0) {
      progress.show(
          fmt::format("{}: {:.0f} % checked", rows_->name(), 100 * rows_->fraction_read()));
    }
  }
  survey_.late = prepared_.late();
  survey_.gaps = prepared_.gaps();
  if (!intervals.empty()) survey_.intervals = measure_intervals(intervals, survey_.longest);
  survey_.median = median_of(intervals);
  if (survey_.rows > 0) return;
  std::string_view why = "there are no waypoints";
  if (prepared_.has_rows()) why = "no waypoint is within --from and --duration";
  if (prepared_.has_selected()) why = "no waypoint can be sent";
  throw InputError(fmt::format("{}: {}", rows_->name(), why));
}

bool Recording::next(PreparedRow& row) {
  if (prepared_.next(row, refused_, true)) {
    ++passed_;
    if (passed_ <= survey_.rows) return true;
  }
  if (passed_ == survey_.rows) return false;
  throw InputError(
      fmt::format("{}: was changed after it had been read for the first time", rows_->name()));
}

void Recording::rewind() {
  prepared_.rewind();
  passed_ = 0;
}

LateRows prepare(WaypointTable& table, const Preparation& how, RefusedRows* refused) {
  WaypointTable kept;
  kept.file = table.file;
  kept.names = table.names;
  kept.kinds = table.kinds;
  kept.source = table.source;
  LateRows late;
  {
    Recording recording(std::make_unique<TableRows>(table), table.kinds, how, refused);
    late = recording.survey().late;
    recording.rewind();
    for (PreparedRow row; recording.next(row);) {
      kept.times.push_back(row.time);
      kept.lines.push_back(row.number);
      const auto append = [](std::span<const double> from, std::vector<double>& to) {
        to.insert(to.end(), from.begin(), from.end());
      };
      append(row.position, kept.positions);
      append(row.velocity, kept.velocities);
      append(row.acceleration, kept.accelerations);
    }
  }
  table = std::move(kept);
  return late;
}

}  // namespace splinecast::apps
