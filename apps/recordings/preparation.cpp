#include "apps/recordings/preparation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/cli/options.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/kinds.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/status.hpp"

namespace splinecast::apps {

PreparedRows::PreparedRows(RowReader& rows, std::vector<Dimension> kinds, const Preparation& how)
    : rows_(rows), kinds_(std::move(kinds)), dimension_kinds_(kinds_), how_(how) {
  set_median(Time::zero());
}

void PreparedRows::set_median(Time median) noexcept {
  step_ = std::max(how_.intervals.least, std::min(how_.intervals.most, median));
  // Gaps are measured in time of the recording, before the rate.
  const double recorded = std::min(to_seconds(median) * how_.rate, to_seconds(kLatestTime));
  gap_ = gap_length(how_.gap, from_seconds(recorded));
}

void PreparedRows::rewind() {
  rows_.rewind();
  state_ = {};
}

bool PreparedRows::next_selected(Row& row) {
  for (;;) {
    try {
      if (!rows_.next(row)) return false;
    } catch (const InputError&) {
      if (row.number == 0) throw;
      continue;
    }
    if (!is_selected(row.time)) continue;
    apply_rate(row);
    return true;
  }
}

bool PreparedRows::next(PreparedRow& row, RefusedRows* refused, bool is_repeated) {
  for (;;) {
    try {
      if (!rows_.next(row)) return false;
    } catch (const InputError& error) {
      if (refused == nullptr || row.number == 0) throw;
      if (is_repeated) continue;
      refused->add({.by = RefusedBy::file, .reason = kUnreadable, .number = row.number},
                   error.what());
      continue;
    }
    if (!is_selected(row.time)) continue;
    const Time recorded = row.time;
    apply_rate(row);
    if (judge(row, recorded, refused, is_repeated)) return true;
  }
}

/// Whether a row is within `from` and `duration`. Notes the first one.
bool PreparedRows::is_selected(Time t) {
  if (!state_.first) state_.first = t;
  const Time begin = saturated_sum(*state_.first, how_.from.value_or(Time::zero()));
  if (how_.from && t < begin) return false;
  if (how_.duration && t > saturated_sum(begin, *how_.duration)) return false;
  if (!state_.selected) state_.selected = t;
  return true;
}

void PreparedRows::apply_rate(Row& row) {
  if (how_.rate == 1.0) return;
  constexpr double kMost = 9.2e18;  // range of llround; later than any valid time
  const auto elapsed = static_cast<double>((row.time - *state_.selected).count()) / how_.rate;
  if (elapsed > static_cast<double>(kLongestTime.count())) {
    throw InputError(
        fmt::format("{}: at --rate {} this row comes {} s after the first one; the maximum is {} s",
                    rows_.where(row.number), how_.rate,
                    to_seconds(row.time - *state_.selected) / how_.rate, to_seconds(kLongestTime)));
  }
  row.time = saturated_sum(*state_.selected, Time(std::llround(std::max(elapsed, -kMost))));
  double factor = how_.rate;
  for (const auto& [values, scaled] :
       {std::pair(&row.velocity, &scaled_[0]), std::pair(&row.acceleration, &scaled_[1])}) {
    scaled->assign(values->begin(), values->end());
    for (double& value : *scaled) value *= factor;
    *values = *scaled;
    factor *= how_.rate;
  }
}

/// Whether a row remains. May change its time.
bool PreparedRows::judge(PreparedRow& row, Time recorded, RefusedRows* refused, bool is_repeated) {
  if (const auto bad = judge_values(row)) return refuse(row, *bad, refused, is_repeated);
  if (state_.has_last && row.time <= state_.last) {
    const Time lateness = state_.last - row.time;
    const bool is_duplicate = lateness == Time::zero();
    state_.late.count(is_duplicate ? &LateRows::duplicate : &LateRows::out_of_order, lateness);
    if (how_.late != LatePolicy::refuse) return keeps_late(row, recorded, refused, is_repeated);
  }
  row.follows_gap = note_gap(row, recorded);
  if (const auto bad = time_refusal(row, row.follows_gap)) {
    return refuse(row, *bad, refused, is_repeated);
  }
  return keep(row, recorded);
}

std::optional<PreparedRows::Objection> PreparedRows::judge_values(const Row& row) const {
  if (!ipc::is_finite(row.position) || !ipc::is_finite(row.velocity) ||
      !ipc::is_finite(row.acceleration)) {
    return objection(row, AppendStatus::not_finite, value_in(row));
  }
  if (dimension_kinds_.all_linear()) return std::nullopt;
  if (const auto bad = zero_quaternion(row.position, rows_.columns().names, dimension_kinds_)) {
    return Objection{to_string(Refusal::zero_quaternion),
                     fmt::format("{}: waypoint refused: {}", rows_.where(row.number), *bad)};
  }
  return std::nullopt;
}

std::string PreparedRows::value_in(const Row& row) const {
  const std::array<const char*, 3> letters{"", "v of ", "a of "};
  const std::array parts{row.position, row.velocity, row.acceleration};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t d = 0; d < parts[p].size(); ++d) {
      if (is_usable(parts[p][d])) continue;
      return fmt::format("column '{}{}': {}", letters[p], shown(rows_.columns().names[d]),
                         parts[p][d]);
    }
  }
  return {};
}

/// Whether a gap precedes the row that is to be split. Counts gaps.
bool PreparedRows::note_gap(const Row& row, Time recorded) {
  const Time length = recorded - state_.last_recorded;
  if (!state_.has_last || length <= gap_ || row.time <= state_.last) return false;
  if (how_.gap.policy == GapPolicy::refuse) {
    throw InputError(gap_refusal(rows_.where(row.number), length, rows_.where(state_.last_number)));
  }
  state_.gaps.add({.length = length, .after = state_.last_number, .before = row.number});
  return how_.gap.policy == GapPolicy::split;
}

std::optional<PreparedRows::Objection> PreparedRows::time_refusal(const Row& row,
                                                                  bool is_split) const {
  if (!state_.has_last) return std::nullopt;
  auto status = ipc::judge_interval(row.time - state_.last, how_.intervals);
  if (is_split && status == AppendStatus::too_far_apart) status = AppendStatus::accepted;
  if (!is_time_in_range(moved(row.time))) status = AppendStatus::too_far_apart;
  if (status == AppendStatus::accepted) return std::nullopt;
  return objection(row, status,
                   fmt::format("time {} ns, {} ns after the previous waypoint", row.time.count(),
                               (row.time - state_.last).count()));
}

PreparedRows::Objection PreparedRows::objection(const Row& row, AppendStatus status,
                                                const std::string& value) const {
  const std::string_view why = to_string(status);
  return {why, fmt::format("{}: waypoint refused: {}: {}", rows_.where(row.number), why, value)};
}

bool PreparedRows::keeps_late(PreparedRow& row, Time recorded, RefusedRows* refused,
                              bool is_repeated) {
  if (how_.late == LatePolicy::pass || is_copy_of_last(row)) {
    ++state_.late.left_out;
    return false;
  }
  const Time by = saturated_sum(state_.last - row.time, step_);
  if (!is_time_in_range(saturated_sum(moved(row.time), by))) {
    return refuse(row,
                  objection(row, AppendStatus::too_far_apart,
                            fmt::format("time {} ns, to be shifted", row.time.count())),
                  refused, is_repeated);
  }
  state_.late.shift(by);
  return keep(row, recorded);
}

bool PreparedRows::is_copy_of_last(const Row& row) const {
  const std::array parts{row.position, row.velocity, row.acceleration};
  return row.time == state_.last && std::ranges::equal(parts, last_, [](auto a, const auto& b) {
           return std::ranges::equal(a, b);
         });
}

bool PreparedRows::keep(PreparedRow& row, Time recorded) {
  state_.has_last = true;
  state_.last_recorded = recorded;
  state_.last = row.time;
  state_.last_number = row.number;
  row.time = moved(row.time);
  if (how_.late == LatePolicy::shift) {
    last_[0].assign(row.position.begin(), row.position.end());
    last_[1].assign(row.velocity.begin(), row.velocity.end());
    last_[2].assign(row.acceleration.begin(), row.acceleration.end());
  }
  return true;
}

bool PreparedRows::refuse(const Row& row, const Objection& objection, RefusedRows* refused,
                          bool is_repeated) {
  if (refused == nullptr) throw InputError(objection.message);
  if (!is_repeated) {
    refused->add({.by = RefusedBy::file, .reason = objection.reason, .number = row.number},
                 objection.message);
  }
  return false;
}

}  // namespace splinecast::apps
