#include "apps/fit/report_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

constexpr std::int64_t kRowsAcross = 1600;     // least number of rows over the whole time
constexpr std::int64_t kMostValues = 400'000;  // per derivative: a few MB of the file
constexpr std::size_t kBuckets = 2000;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A time at which curves are evaluated: as the limit from the left, or from the right.
struct Instant {
  Time time{};
  bool from_left = false;
};

/// The instants from each break to the next: at least `fewest` steps, none longer than `longest`.
std::vector<Instant> instants_of(const std::vector<Time>& breaks, std::int64_t fewest,
                                 Time longest) {
  if (breaks.size() == 1) return {{.time = breaks.front(), .from_left = false}};
  std::vector<Instant> instants;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const Time h = breaks[i + 1] - breaks[i];
    const std::int64_t steps = std::max(fewest, h / longest + 1);
    for (std::int64_t k = 0; k <= steps; ++k) {
      const Time after = h / steps * k + h % steps * k / steps;
      instants.push_back({.time = breaks[i] + after, .from_left = k == steps});
    }
  }
  return instants;
}

/// Evaluates a curve. All values are NaN outside its time range.
void evaluate(const PiecewisePolynomial& curve, const Instant& at, State& out) {
  if (at.time < curve.breaks().front() || at.time > curve.breaks().back()) {
    std::ranges::fill(out.ref().position, kNone);
    std::ranges::fill(out.ref().velocity, kNone);
    std::ranges::fill(out.ref().acceleration, kNone);
    std::ranges::fill(out.ref().jerk, kNone);
    return;
  }
  std::size_t i = curve.segment_at(at.time);
  if (at.from_left && i > 0 && at.time == curve.left_of(i)) --i;
  core::evaluate(curve.order_of(i), curve.coefficients(i), to_seconds(at.time - curve.left_of(i)),
                 out.ref());
}

ReportRows sampled(std::span<const ReportCurve> curves, const std::vector<Instant>& instants) {
  ReportRows rows;
  for (const Instant& at : instants) {
    rows.seconds.push_back(to_seconds(at.time - instants.front().time));
  }
  const std::size_t columns = curves.front().curve.dimensions() * kDerivatives;
  State state(curves.front().curve.dimensions());
  rows.values.resize(curves.size() * columns * instants.size());
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (std::size_t row = 0; row < instants.size(); ++row) {
      evaluate(curves[c].curve, instants[row], state);
      for (std::size_t r = 0; r < kDerivatives; ++r) {
        for (std::size_t d = 0; d < state.dimensions(); ++d) {
          const std::size_t column = c * columns + d * kDerivatives + r;
          rows.values[column * instants.size() + row] = state.values()[r * state.dimensions() + d];
        }
      }
    }
  }
  return rows;
}

/// Length of the interval that a pair of rows represents.
Time bucket_of(const std::vector<Instant>& instants) {
  return (instants.back().time - instants.front().time) / kBuckets + Time(1);
}

/// The least and greatest values of one column in equal intervals of time.
class Envelope {
 public:
  Envelope(Time first, Time bucket) : first_(first), bucket_(bucket) {}

  void consider(Time time, double value) {
    Extremes& e = extremes_[static_cast<std::size_t>((time - first_) / bucket_)];
    if (!(value >= e.least.value)) e.least = {.time = time, .value = value};
    if (!(value <= e.greatest.value)) e.greatest = {.time = time, .value = value};
  }

  /// Writes two values per interval, in time order; NaN for an interval without values.
  void write(std::span<double> out) const {
    for (std::size_t i = 0; i < kBuckets; ++i) {
      const Extremes& e = extremes_[i];
      const bool rises = e.least.time <= e.greatest.time;
      out[2 * i] = rises ? e.least.value : e.greatest.value;
      out[2 * i + 1] = rises ? e.greatest.value : e.least.value;
    }
  }

 private:
  Time first_;
  Time bucket_;
  std::vector<Extremes> extremes_{kBuckets, Extremes{.least = {.time = {}, .value = kNone},
                                                     .greatest = {.time = {}, .value = kNone}}};
};

/// Writes the columns of one curve. The extremes of the whole curve are exact; those of a single
/// interval are the extremes of its samples.
void write_envelopes(const PiecewisePolynomial& curve, const ReportTable& table,
                     const std::vector<Instant>& instants, std::span<double> out) {
  const std::size_t dimensions = curve.dimensions();
  std::vector<Envelope> envelopes(dimensions * kDerivatives,
                                  Envelope(instants.front().time, bucket_of(instants)));
  State state(dimensions);
  for (const Instant& at : instants) {
    evaluate(curve, at, state);
    if (std::isnan(state.values().front())) continue;
    for (std::size_t i = 0; i < envelopes.size(); ++i) {
      envelopes[i].consider(at.time, state.values()[i]);
    }
  }
  for (std::size_t i = 0; i < envelopes.size(); ++i) {
    const std::size_t d = i % dimensions;
    const std::size_t r = i / dimensions;
    const Extremes& all = table.rows[d * kDerivatives + r].extremes;
    for (const Extremum& e : {all.least, all.greatest}) envelopes[i].consider(e.time, e.value);
    envelopes[i].write(out.subspan((d * kDerivatives + r) * 2 * kBuckets, 2 * kBuckets));
  }
}

ReportRows decimated(std::span<const ReportCurve> curves, std::span<const ReportTable> tables,
                     const std::vector<Instant>& instants) {
  ReportRows rows;
  rows.bucket = to_seconds(bucket_of(instants));
  for (std::size_t row = 0; row < 2 * kBuckets; ++row) {
    rows.seconds.push_back((static_cast<double>(row) / 2 + 0.25) * rows.bucket);
  }
  const std::size_t size = curves.front().curve.dimensions() * kDerivatives * 2 * kBuckets;
  rows.values.resize(curves.size() * size);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    write_envelopes(curves[c].curve, tables[c], instants,
                    std::span(rows.values).subspan(c * size, size));
  }
  return rows;
}

}  // namespace

std::vector<Time> breaks_of(std::span<const ReportCurve> curves) {
  std::vector<Time> breaks;
  for (const ReportCurve& curve : curves) {
    std::vector<Time> both;
    std::ranges::set_union(breaks, curve.curve.breaks(), std::back_inserter(both));
    breaks = std::move(both);
  }
  return breaks;
}

ReportRows rows_of(std::span<const ReportCurve> curves, std::span<const ReportTable> tables) {
  const auto breaks = breaks_of(curves);
  const Time span = breaks.back() - breaks.front();
  const auto columns = static_cast<std::int64_t>(curves.size() * curves.front().curve.dimensions());
  const auto most_rows = std::clamp<std::int64_t>(kMostValues / columns, 4000, 40'000);
  const std::int64_t steps = most_rows / static_cast<std::int64_t>(breaks.size()) - 1;
  if (steps < 2) {
    return decimated(
        curves, tables,
        instants_of(breaks, 3, span / (2 * static_cast<std::int64_t>(kBuckets)) + Time(1)));
  }
  return sampled(
      curves, instants_of(breaks, std::min<std::int64_t>(steps, 6), span / kRowsAcross + Time(1)));
}

}  // namespace splinecast::apps
