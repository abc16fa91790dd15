#include "apps/recordings/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>

#include "apps/process/exit_codes.hpp"
#include "core/basics/quantile.hpp"

namespace splinecast::apps {
namespace {

/// Finds chords between rows of a table: at least kChord long, without a gap.
class Chords {
 public:
  Chords(const WaypointTable& table, Time gap_from) : table_(&table), run_(table.size(), 0) {
    for (std::size_t i = 1; i < table.size(); ++i) {
      run_[i] = run_[i - 1] + (table.times[i] - table.times[i - 1] > gap_from ? 1 : 0);
    }
  }

  /// The last row of the shortest chord from row i; nothing if there is no chord.
  [[nodiscard]] std::optional<std::size_t> end(std::size_t i) const {
    const auto first = table_->times.begin() + static_cast<std::ptrdiff_t>(i);
    const auto at = std::lower_bound(first, table_->times.end(), saturated_sum(*first, kChord));
    const auto j = static_cast<std::size_t>(at - table_->times.begin());
    return j < table_->size() && run_[i] == run_[j] ? std::optional(j) : std::nullopt;
  }

  [[nodiscard]] bool is_joined(std::size_t i, std::size_t j) const { return run_[i] == run_[j]; }

 private:
  const WaypointTable* table_;
  std::vector<std::size_t> run_;  ///< for each row, the number of gaps before it
};

double position(const WaypointTable& table, std::size_t i, std::size_t d) {
  return table.positions[i * table.dimensions() + d];
}

double chord_velocity(const WaypointTable& table, std::size_t i, std::size_t j, std::size_t d) {
  return (position(table, j, d) - position(table, i, d)) /
         to_seconds(table.times[j] - table.times[i]);
}

/// The magnitude of the third divided difference of rows i to i + 3, scaled so that independent
/// errors of the positions with standard deviation 1 give it the standard deviation 1.
double third_difference(const WaypointTable& table, std::size_t i, std::size_t d) {
  const double unit = to_seconds(table.times[i + 3] - table.times[i]);
  double sum = 0;
  double squares = 0;
  for (std::size_t k = i; k < i + 4; ++k) {
    double weight = 1;
    for (std::size_t other = i; other < i + 4; ++other) {
      if (other == k) continue;
      weight *= unit / to_seconds(table.times[k] - table.times[other]);
    }
    sum += weight * (position(table, k, d) - position(table, i, d));
    squares += weight * weight;
  }
  return std::abs(sum) / std::sqrt(squares);
}

/// The rounding error of positions that mostly stay the same: their least step divided by √12.
double rounding_noise(const WaypointTable& table, std::size_t d) {
  double least = 0;
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double step = std::abs(position(table, i, d) - position(table, i - 1, d));
    if (step > 0 && (least == 0 || step < least)) least = step;
  }
  return least / std::sqrt(12.0);
}

double measure_noise(const WaypointTable& table, const Chords& chords, std::size_t d) {
  std::vector<double> differences;
  for (std::size_t i = 0; i + 3 < table.size(); ++i) {
    if (chords.is_joined(i, i + 3)) differences.push_back(third_difference(table, i, d));
  }
  constexpr double kSigmaPerMedian = 1.4826;  // of a normal distribution
  const double median = core::quantile(std::span(differences), 0.5);
  return median > 0 ? kSigmaPerMedian * median : rounding_noise(table, d);
}

/// The rows of two consecutive chords, which give a velocity and an acceleration.
struct ChordPair {
  std::size_t i, j, k;
  bool moves;  ///< whether a dimension moves along the first chord
};

/// Whether a dimension moves along a chord by more than the noise.
bool moves(const WaypointTable& table, std::size_t i, std::size_t j,
           std::span<const DimensionMotion> motion) {
  constexpr double kAboveNoise = 6;
  for (std::size_t d = 0; d < motion.size(); ++d) {
    const double distance = std::abs(position(table, j, d) - position(table, i, d));
    if (distance > kAboveNoise * motion[d].noise) return true;
  }
  return false;
}

std::vector<ChordPair> chord_pairs(const WaypointTable& table, const Chords& chords,
                                   std::span<const DimensionMotion> motion) {
  std::vector<ChordPair> pairs;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto j = chords.end(i);
    const auto k = j ? chords.end(*j) : std::nullopt;
    if (k) pairs.push_back({i, *j, *k, moves(table, i, *j, motion)});
  }
  // In a recording without motion all pairs count: they measure its noise.
  if (std::ranges::none_of(pairs, &ChordPair::moves)) {
    for (ChordPair& pair : pairs) pair.moves = true;
  }
  return pairs;
}

void measure_dimension(const WaypointTable& table, const std::vector<ChordPair>& pairs,
                       std::size_t d, DimensionMotion& out) {
  std::vector<double> velocities;
  std::vector<double> accelerations;
  for (const auto& [i, j, k, is_moving] : pairs) {
    if (!is_moving) continue;
    const double before = chord_velocity(table, i, j, d);
    const double after = chord_velocity(table, j, k, d);
    velocities.push_back(std::max(std::abs(before), std::abs(after)));
    const double between = to_seconds(table.times[k] - table.times[i]) / 2;
    accelerations.push_back(std::abs(after - before) / between);
  }
  out.velocity = core::quantile(std::span(velocities), 0.95);
  out.peak_velocity = std::ranges::max(velocities);
  out.acceleration = core::quantile(std::span(accelerations), 0.95);
  out.peak_acceleration = std::ranges::max(accelerations);
}

}  // namespace

Intervals measure_intervals(std::span<const Time> times) {
  std::vector<Time> all;
  for (std::size_t i = 1; i < times.size(); ++i) all.push_back(times[i] - times[i - 1]);
  return measure_intervals(all, std::ranges::max(all));
}

Intervals measure_intervals(std::vector<Time>& intervals, Time largest) {
  Intervals found{.median = core::quantile(std::span(intervals), 0.5),
                  .p5 = core::quantile(std::span(intervals), 0.05),
                  .p95 = core::quantile(std::span(intervals), 0.95),
                  .largest = largest};
  std::vector<Time> deviations;
  for (const Time interval : intervals) {
    if (interval > found.gap_from()) ++found.gaps;
    deviations.push_back(std::chrono::abs(interval - found.median));
  }
  if (found.gaps > 0) found.longest_gap = found.largest;
  found.jitter = core::quantile(std::span(deviations), 0.95);
  return found;
}

std::vector<DimensionMotion> measure_motion(const WaypointTable& table,
                                            const Intervals& intervals) {
  const Chords chords(table, intervals.gap_from());
  std::vector<DimensionMotion> motion(table.dimensions());
  for (std::size_t d = 0; d < motion.size(); ++d) {
    motion[d].noise = measure_noise(table, chords, d);
  }
  const std::vector<ChordPair> pairs = chord_pairs(table, chords, motion);
  if (pairs.empty()) {
    throw InputError(fmt::format(
        "{}: {} rows are too few to measure an acceleration: it needs three rows, {} s apart from "
        "each other, without a gap of more than {} s",
        table.file, table.size(), to_seconds(kChord), to_seconds(intervals.gap_from())));
  }
  for (std::size_t d = 0; d < motion.size(); ++d) measure_dimension(table, pairs, d, motion[d]);
  return motion;
}

}  // namespace splinecast::apps
