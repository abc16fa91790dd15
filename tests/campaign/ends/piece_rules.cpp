#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/campaign/ends/curve_watch.hpp"

/// The rules of the pieces of a published curve, and of its end.
namespace splinecast::campaign::ends {
namespace {

constexpr double kSlack = 1 + 1e-6;
/// The first segments of a live stream that starts at rest are not compared with limits.
constexpr std::size_t kFirstCompared = 3;
/// Longest time from the last waypoint, the finish and the rest before it, to the rest.
constexpr Time kLatestRest = std::chrono::seconds(5);
/// The same for an end by an entry.
constexpr Time kLatestEntry = std::chrono::seconds(60);
/// Length of the longest stop: one that limits would make longer exceeds them.
constexpr double kLongestStop = 1e6;
/// A longer entry may exceed the motion shown.
constexpr double kLongEntry = 2.9;

constexpr std::array kLimitNames{"velocity", "acceleration", "jerk"};

bool has(const std::vector<double>& limits, std::size_t d) {
  return !limits.empty() && limits[d] > 0;
}

}  // namespace

void CurveWatch::check_piece(const Piece& piece, const Piece* former, bool finishes) {
  if (limits_->empty() && piece.kind != SegmentKind::entry && !finishes) {
    if (piece.kind != SegmentKind::stop) return;
  }
  const Peaks peaks = peaks_of(ranges_, piece, *limits_);
  switch (piece.kind) {
    case SegmentKind::stop:
      return check_stop(piece, peaks);
    case SegmentKind::entry:
      return check_entry(piece, peaks, finishes);
    case SegmentKind::hold:
      return;
    default:
      if (!finishes) return check_spline(piece, peaks, former);
      if (former == nullptr || former->kind != SegmentKind::spline || !knows_path_) return;
      check_no_worse(piece, peaks, *former);
      check_shown(piece, former, Rule::end_shown);
  }
}

void CurveWatch::check_stop(const Piece& piece, const Peaks& peaks) {
  tally_->count(Event::stops);
  // The solver counts the excess of a stop that the curve has begun.
  const bool has_begun = piece.left < summary_.settled_until;
  const bool is_counted = summary_.exceeding > 0 || !has_begun;
  if (piece.seconds() >= kLongestStop) {
    if (!is_counted) breach(Rule::endless_stops, piece, "a stop");
    return;
  }
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    // Some rotations are so fast that no stop keeps their limits.
    if (!ranges_.is_rotation(d) || !is_counted) check_stop_limits(piece, peaks, d);
  }
  bool passes_bound = false;
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d)) continue;
    const double v0 = std::abs(ranges_.value(piece, d, 1, 0));
    const double v = ranges_.range(piece, d, 1).size();
    if (v > v0 * kSlack + 1e-9 * ranges_.scale(piece, d, 1)) {
      breach(Rule::stop_slows, piece, fmt::format("dimension {}: {} from {}", d, v, v0));
    }
    const double x0 = ranges_.value(piece, d, 0, 0);
    const Range& x = peaks.position[d];
    const double rounding = 1e-9 * (1 + ranges_.scale(piece, d, 0));
    passes_bound =
        passes_bound ||
        (!limits_->lower.empty() && x.least < std::min(limits_->lower[d], x0) - rounding) ||
        (!limits_->upper.empty() && x.greatest > std::max(limits_->upper[d], x0) + rounding);
  }
  if (!passes_bound) return;
  tally_->count(Event::stops_past_bounds);
  if (!is_counted) breach(Rule::stop_bounds, piece, "a stop passes a bound");
}

/// In a stop, a velocity may begin beyond its limit.
void CurveWatch::check_stop_limits(const Piece& piece, const Peaks& peaks, std::size_t d) {
  const bool turns = ranges_.is_rotation(d);
  const bool follows_entry = std::ranges::any_of(pieces_, [&](const Piece& other) {
    return other.right == piece.left && other.kind == SegmentKind::entry;
  });
  for (std::size_t m = turns ? 1 : 0; m < kLimitNames.size(); ++m) {
    double most = 1;
    if (m == 0 && has(limits_->velocity, d)) {
      most = std::max(most, std::abs(ranges_.value(piece, d, 1, 0)) / limits_->velocity[d]);
    }
    const double ratio = peaks.ratio[d][m];
    const double at_rate = ratio * std::pow(plan_->rate, static_cast<int>(m) + 1);
    if (ratio > most * kSlack) {
      breach(turns           ? Rule::rotation_stops
             : follows_entry ? Rule::entered_stop_limits
                             : Rule::stop_limits,
             piece,
             fmt::format("{} of dimension {}: {} times its limit", kLimitNames[m], d, ratio));
    } else if (m > 0 && plan_->rate > 1 && at_rate > kSlack) {
      breach(Rule::law_rate, piece,
             fmt::format("{} of dimension {}: {} times its limit at the rate {}", kLimitNames[m], d,
                         at_rate, plan_->rate));
    }
  }
}

void CurveWatch::check_entry(const Piece& piece, const Peaks& peaks, bool finishes) {
  tally_->count(Event::entries);
  const std::array<const std::vector<double>*, 2> all{&limits_->velocity, &limits_->acceleration};
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    for (std::size_t m = 0; m < kLimitNames.size(); ++m) {
      double most = 1;
      if (m < 2 && has(*all[m], d)) {
        const double begin = ranges_.is_rotation(d)
                                 ? HUGE_VAL  // the solver's bound of it is not that of a rotation
                                 : std::abs(ranges_.value(piece, d, static_cast<int>(m) + 1, 0));
        most = std::max(most, begin / (*all[m])[d]);
      }
      if (m == 1 && most > kSlack && peaks.ratio[d][m] > kSlack && !ranges_.is_rotation(d)) {
        breach(Rule::entry_begins, piece, "acceleration");
      }
      if (peaks.ratio[d][m] <= most * kSlack) continue;
      breach(Rule::entry_limits, piece,
             fmt::format("{} of dimension {}: {} times its limit, begins with {}", kLimitNames[m],
                         d, peaks.ratio[d][m], most));
    }
  }
  check_entry_bounds(piece, peaks, Time::max(), is_cut_ ? Rule::cut_bounds : Rule::entry_bounds);
  check_shown(piece, nullptr, finishes ? Rule::end_shown : Rule::entry_shown);
}

/// An entry stays within the bounds or, outside of them, within the positions of the curve that it
/// replaces; the entry that ends a curve stays within those up to `until`.
void CurveWatch::check_entry_bounds(const Piece& piece, const Peaks& peaks, Time until, Rule rule) {
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d)) continue;
    const bool is_end = rule == Rule::end_within_path;
    if (!is_end && limits_->lower.empty()) continue;
    const double x0 = ranges_.value(piece, d, 0, 0);
    const double x1 = ranges_.value(piece, d, 0, piece.seconds());
    double least = is_end ? std::min(x0, x1) : std::min(limits_->lower[d], x0);
    double greatest = is_end ? std::max(x0, x1) : std::max(limits_->upper[d], x0);
    for (const Piece& old : old_) {
      if (old.right <= piece.left || old.left >= until) continue;
      const double from = old.left < piece.left ? to_seconds(piece.left - old.left) : 0;
      const Range range = ranges_.range(old, d, 0, from);
      least = std::min(least, range.least);
      greatest = std::max(greatest, range.greatest);
    }
    // Ranges are exact to 10⁻⁷.
    const double rounding = 1e-6 * (greatest - least) + 1e-6 * ranges_.scale(piece, d, 0);
    const Range& x = peaks.position[d];
    if (std::isinf(greatest - least)) {
      if (x.least >= least - 1e-9 * (1 + std::abs(least)) &&
          x.greatest <= greatest + 1e-9 * (1 + std::abs(greatest))) {
        continue;
      }
    }
    if (x.least >= least - rounding && x.greatest <= greatest + rounding) continue;
    breach(rule, piece,
           fmt::format("dimension {}: {} to {}, allowed {} to {}", d, x.least, x.greatest, least,
                       greatest));
  }
}

/// The largest acceleration that a motion has shown: here three times its largest values, where the
/// solver takes quantiles.
double CurveWatch::shown(std::size_t d) const {
  constexpr double kFactor = 3;
  constexpr double kLeast = 1e-9;
  const double stop = to_seconds(plan_->stream.window.stop_length);
  return std::max({kFactor * acceleration_[d], kFactor * velocity_[d] / stop, kLeast});
}

/// Without a limit of acceleration, entries and ends keep what the motion has shown. Motions that
/// replace others are not compared.
void CurveWatch::check_shown(const Piece& piece, const Piece* former, Rule rule) {
  constexpr double kShownSlack = 1.25;
  const bool is_entry = piece.kind == SegmentKind::entry;
  const bool is_long = is_entry && to_seconds(piece.natural_right - piece.left) > kLongEntry;
  if (is_long || is_replaced_) return;
  double worst = 1;  // of the path without the end
  for (std::size_t d = 0; d < ranges_.dimensions() && former != nullptr; ++d) {
    if (ranges_.is_rotation(d)) continue;
    const double limit = has(limits_->acceleration, d) ? limits_->acceleration[d] : shown(d);
    worst = std::max(worst, ranges_.range(*former, d, 2).size() / limit);
  }
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d) || has(limits_->acceleration, d)) continue;
    double most = worst * shown(d);
    if (is_entry) {
      const double end = piece.seconds();
      const double way = ranges_.value(piece, d, 0, end) - ranges_.value(piece, d, 0, 0);
      most =
          std::max({most, 6 * std::abs(way), entered_[d], std::abs(ranges_.value(piece, d, 2, 0)),
                    std::abs(ranges_.value(piece, d, 2, end))});
    }
    const double a = ranges_.range(piece, d, 2).size();
    if (a <= most * kShownSlack) continue;
    breach(rule, piece, fmt::format("dimension {}: acceleration {}, shown {}", d, a, most));
  }
}

/// A spline that exceeds a limit is counted.
void CurveWatch::check_spline(const Piece& piece, const Peaks& peaks, const Piece* former) {
  const auto& times = plan_->motion.times;
  const Time compared = times[std::min(kFirstCompared, times.size() - 1)];
  const bool is_first = piece.left < compared || piece.number <= kFirstCompared;
  if (is_first || summary_.exceeding > 0) return;
  const Peaks before = former == nullptr ? Peaks{} : peaks_of(ranges_, *former, *limits_);
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    for (std::size_t m = 0; m < kLimitNames.size(); ++m) {
      if (peaks.ratio[d][m] <= kSlack || before.ratio[d][m] > 1) continue;
      return breach(Rule::excess_counted, piece,
                    fmt::format("{} of dimension {}: {} times its limit", kLimitNames[m], d,
                                peaks.ratio[d][m]));
    }
  }
}

/// A piece of an end exceeds no limit that the path keeps, and none more than the path.
void CurveWatch::check_no_worse(const Piece& piece, const Peaks& peaks, const Piece& former) {
  const Peaks before = peaks_of(ranges_, former, *limits_);
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    for (std::size_t m = 0; m < kLimitNames.size(); ++m) {
      if (peaks.ratio[d][m] <= std::max(1.0, before.ratio[d][m]) * kSlack) continue;
      breach(Rule::end_limits, piece,
             fmt::format("{} of dimension {}: {} times its limit, without the end {}",
                         kLimitNames[m], d, peaks.ratio[d][m], before.ratio[d][m]));
    }
    if (ranges_.is_rotation(d) || limits_->lower.empty()) continue;
    const Range& x = peaks.position[d];
    const Range& old = before.position[d];
    // Ranges are exact to 10⁻⁷.
    const double rounding = 2e-7 * (1 + ranges_.scale(piece, d, 0));
    const double low = std::max(limits_->lower[d] - x.least, 0.0);
    const double high = std::max(x.greatest - limits_->upper[d], 0.0);
    const double most =
        std::max({0.0, limits_->lower[d] - old.least, old.greatest - limits_->upper[d]});
    if (most > 0) tally_->count(Event::ends_outside_bounds);
    if (std::max(low, high) <= most * kSlack + rounding) continue;
    breach(
        Rule::end_bounds, piece,
        fmt::format("dimension {}: {} to {}, without the end {} to {}, bounds {} to {}", d, x.least,
                    x.greatest, old.least, old.greatest, limits_->lower[d], limits_->upper[d]));
  }
}

Time CurveWatch::newest_waypoint() const { return summary_.newest_time; }

/// Whether the curve rests where its newest waypoint is.
bool CurveWatch::rests_at_newest() const {
  const Motion& motion = plan_->motion;
  const auto found = std::ranges::find(motion.times, newest_waypoint());
  if (found == motion.times.end()) return false;
  const auto i = static_cast<std::size_t>(found - motion.times.begin());
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (plan_->stream.dimensions[d].kind != DimensionKind::linear) continue;
    const double off =
        ranges_.value(last(), d, 0, last().seconds()) - motion.value(i, 0, ranges_.dimensions())[d];
    if (std::abs(off) > 1e-9 * (1 + ranges_.scale(last(), d, 0))) return false;
  }
  return true;
}

/// The time that the limits require from where the curve goes without the last piece to the end of
/// that piece, from rest to rest.
double CurveWatch::seconds_to(const Piece& piece) const {
  double most = 0;
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    const double end = ranges_.value(piece, d, 0, piece.seconds());
    double way = std::abs(end - ranges_.value(piece, d, 0, 0));
    for (const Piece& old : old_) {
      const Range range = old.right > piece.left ? ranges_.range(old, d, 0) : Range{end, end};
      way = std::max({way, end - range.least, range.greatest - end});
    }
    const double v = std::abs(ranges_.value(piece, d, 1, 0));
    if (has(limits_->velocity, d)) most = std::max(most, 1.9 * way / limits_->velocity[d]);
    if (has(limits_->acceleration, d)) {
      most = std::max({most, std::sqrt(5.8 * way / limits_->acceleration[d]),
                       2 * v / limits_->acceleration[d]});
    }
    if (has(limits_->jerk, d)) {
      most = std::max(
          {most, std::cbrt(60 * way / limits_->jerk[d]), std::sqrt(6 * v / limits_->jerk[d])});
    }
  }
  return most;
}

/// The end is the one in the summary, and the curve comes to rest in time.
void CurveWatch::check_end() {
  using ipc::EndKind;
  const EndKind kind = summary_.ending();
  tally_->count_end(kind, summary_.end_lateness);
  const Piece& piece = last();
  if (kind == EndKind::slowed) measure_slowing();
  if (kind == EndKind::entered) check_last_entry();
  if (!is_of_kind(kind)) {
    breach(Rule::end_kind, piece,
           fmt::format("kind {}, rests at the newest waypoint: {}", static_cast<int>(kind),
                       rests_at_newest()));
  }
  const Time old_end = old_.empty() ? Time::min() : old_.back().right;
  const Time due = std::max({newest_waypoint(), summary_.committed, old_end});
  const Time late = piece.right - due - from_seconds(3 * seconds_to(piece));
  if (late <= kLatestRest) return;
  const bool is_slow = kind == EndKind::entered && late <= kLatestEntry;
  breach(is_slow ? Rule::slow_entry : Rule::comes_to_rest, piece,
         fmt::format("{} s late, end {}", to_seconds(piece.right - due), static_cast<int>(kind)));
}

/// Whether the curve ends in this way.
bool CurveWatch::is_of_kind(ipc::EndKind kind) const {
  using ipc::EndKind;
  const Piece& piece = last();
  const bool is_decidable =
      !is_replaced_ && summary_.refused == 0 && !plan_->stream.window.interpolant.method->smooths();
  const bool may_be_there = !is_decidable || rests_at_newest();
  const bool is_late = summary_.end_lateness == piece.right - newest_waypoint();
  switch (kind) {
    case EndKind::none:
      return false;
    case EndKind::slowed:
      return piece.kind == SegmentKind::slowed && may_be_there && is_late;
    case EndKind::entered:
      return piece.kind == SegmentKind::entry && may_be_there && is_late;
    case EndKind::stopped:
    case EndKind::in_stop:
      return piece.kind == SegmentKind::stop || piece.kind == SegmentKind::hold;
    case EndKind::as_requested:
      break;
  }
  const bool is_in_time = !is_decidable || piece.right == newest_waypoint();
  return piece.kind != SegmentKind::spline || (may_be_there && is_in_time);
}

/// An entry that ends the curve stays within the path from its begin on. One from where the curve
/// has settled may go as far as the curve without the end.
void CurveWatch::check_last_entry() {
  const Piece& piece = last();
  const bool is_from_knot = std::ranges::any_of(old_, [&](const Piece& old) {
    return old.kind == SegmentKind::spline && old.right == newest_waypoint() &&
           old.left >= piece.left;
  });
  if (is_from_knot && knows_path_) {
    check_entry_bounds(piece, peaks_of(ranges_, piece, *limits_), newest_waypoint(),
                       Rule::end_within_path);
  }
  const bool rested = !old_.empty() && piece.left >= old_.back().right;
  if (rested) tally_->count(Event::ends_from_rest);
}

}  // namespace splinecast::campaign::ends
