#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "core/batch/knots.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

/// lower · a_{i−1} + pivot · a_i + upper · a_{i+1} = right side.
struct Row {
  double lower = 0;
  double pivot = 1;
  double upper = 0;
};

/// The system of the acceleration form (math 5, 7). The unknowns are second derivatives, without a
/// factor.
class AccelerationSystem {
 public:
  /// `knots` holds the waypoints and their measured intervals.
  explicit AccelerationSystem(const KnotRing& knots)
      : knots_(knots), rows_(knots.size()), values_(knots.size() * knots.dimensions()) {
    for (std::size_t i = 1; i < knots_.newest(); ++i) {
      rows_[i] = {.lower = h(i - 1), .pivot = 2 * (h(i - 1) + h(i)), .upper = h(i)};
      for (std::size_t d = 0; d < knots_.dimensions(); ++d) {
        at(i)[d] = 6 * (knots_.chord(i)[d] - knots_.chord(i - 1)[d]);
      }
    }
  }

  /// Writes the row of an end. Not-a-knot removes the end from the system: see `pass`.
  void impose(const Condition& condition, bool is_start) {
    const std::size_t i = is_start ? 0 : knots_.newest();
    const std::size_t interval = is_start ? 0 : i - 1;
    const double inwards = is_start ? 1 : -1;
    const auto value = [&](std::size_t d) {
      return condition.value.empty() ? 0 : condition.value[d];
    };
    const auto right_side = at(i);
    switch (condition.kind) {
      case ConditionKind::velocity:
      case ConditionKind::clamped:
      case ConditionKind::halt:
        rows_[i] = {.lower = is_start ? 0.0 : 1.0, .pivot = 2, .upper = is_start ? 1.0 : 0.0};
        for (std::size_t d = 0; d < right_side.size(); ++d) {
          right_side[d] = inwards * 6 * (knots_.chord(interval)[d] - value(d)) / h(interval);
        }
        break;
      case ConditionKind::not_a_knot:
        pass(is_start);
        break;
      default:
        for (std::size_t d = 0; d < right_side.size(); ++d) right_side[d] = value(d);
    }
  }

  /// Sets the right sides of both ends to `value` in all dimensions and every other right side to
  /// 0.
  void make_homogeneous(double value) {
    std::ranges::fill(values_, 0.0);
    for (const std::size_t i : {std::size_t{0}, knots_.newest()}) std::ranges::fill(at(i), value);
  }

  /// Solves in place: elimination from the left, then back-substitution.
  void solve() {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      const double factor = rows_[i].lower / rows_[i - 1].pivot;
      rows_[i].pivot -= factor * rows_[i - 1].upper;
      for (std::size_t d = 0; d < knots_.dimensions(); ++d) at(i)[d] -= factor * at(i - 1)[d];
    }
    for (std::size_t i = rows_.size(); i-- > 0;) {
      const auto after = i + 1 < rows_.size() ? at(i + 1) : at(i);
      for (std::size_t d = 0; d < knots_.dimensions(); ++d) {
        at(i)[d] = (at(i)[d] - rows_[i].upper * after[d]) / rows_[i].pivot;
      }
    }
  }

  /// Writes the acceleration at an end with not-a-knot, by linear extrapolation from the next two
  /// knots.
  void extrapolate(bool is_start) {
    const std::size_t n = knots_.newest();
    const auto end = at(is_start ? 0 : n);
    const auto next = at(is_start ? 1 : n - 1);
    const auto second = at(is_start ? 2 : n - 2);
    const double ratio = is_start ? h(0) / h(1) : h(n - 1) / h(n - 2);
    for (std::size_t d = 0; d < end.size(); ++d) end[d] = next[d] + ratio * (next[d] - second[d]);
  }

  [[nodiscard]] std::span<double> at(std::size_t i) {
    return std::span(values_).subspan(i * knots_.dimensions(), knots_.dimensions());
  }
  [[nodiscard]] double h(std::size_t i) const { return knots_.row(i).h; }

 private:
  /// Substitutes the acceleration that `extrapolate` writes into the row next to the end, so that
  /// this row no longer refers to the end.
  void pass(bool is_start) {
    const std::size_t n = knots_.newest();
    Row& row = rows_[is_start ? 1 : n - 1];
    const double h_end = is_start ? h(0) : h(n - 1);
    const double h_next = is_start ? h(1) : h(n - 2);
    double& outer = is_start ? row.lower : row.upper;
    double& inner = is_start ? row.upper : row.lower;
    row.pivot += outer * (h_end + h_next) / h_next;
    inner -= outer * h_end / h_next;
    outer = 0;
  }

  const KnotRing& knots_;
  std::vector<Row> rows_;
  std::vector<double> values_;  ///< right sides, then accelerations: [knot][dimension]
};

/// The periodic system: a = y + z·a_join, as in the velocity form.
AccelerationSystem solved_periodic(const KnotRing& knots) {
  const std::size_t n = knots.newest();
  AccelerationSystem y(knots);
  y.solve();
  AccelerationSystem z(knots);
  z.make_homogeneous(1);
  z.solve();
  const double before = y.h(n - 1);
  const double after = y.h(0);
  AccelerationSystem result(knots);
  for (std::size_t d = 0; d < knots.dimensions(); ++d) {
    const double pivot = 2 * (before + after) + before * z.at(n - 1)[d] + after * z.at(1)[d];
    const double right_side = 6 * (knots.chord(0)[d] - knots.chord(n - 1)[d]);
    const double join = (right_side - before * y.at(n - 1)[d] - after * y.at(1)[d]) / pivot;
    for (std::size_t i = 0; i <= n; ++i) result.at(i)[d] = y.at(i)[d] + z.at(i)[d] * join;
  }
  return result;
}

AccelerationSystem solved(const KnotRing& knots, const Condition& start, const Condition& end) {
  if (start.kind == ConditionKind::periodic) return solved_periodic(knots);
  AccelerationSystem system(knots);
  system.impose(start, true);
  system.impose(end, false);
  system.solve();
  if (start.kind == ConditionKind::not_a_knot) system.extrapolate(true);
  if (end.kind == ConditionKind::not_a_knot) system.extrapolate(false);
  return system;
}

/// Knot velocities from accelerations (math 3, and its mirror at the last knot).
void write_velocities(AccelerationSystem& system, KnotRing& knots) {
  const std::size_t n = knots.newest();
  for (std::size_t i = 0; i <= n; ++i) {
    const std::size_t interval = std::min(i, n - 1);
    const double h = i < n ? system.h(interval) : -system.h(interval);
    const auto a = system.at(i);
    const auto other = system.at(i < n ? i + 1 : n - 1);
    const auto v = knots.values(i, KnotRing::kVelocity);
    for (std::size_t d = 0; d < v.size(); ++d) {
      v[d] = knots.chord(interval)[d] - h * (2 * a[d] + other[d]) / 6;
    }
  }
}

/// Powers 2 and 3 of a cubic from its accelerations (math 3).
void write_cubic_part(std::span<const double> a0, std::span<const double> a1, double h,
                      Segment& out) {
  const std::size_t dimensions = a0.size();
  for (std::size_t d = 0; d < dimensions; ++d) {
    out.coefficients[2 * dimensions + d] = a0[d] / 2;
    out.coefficients[3 * dimensions + d] = (a1[d] - a0[d]) / (6 * h);
  }
}

}  // namespace

PiecewisePolynomial c2_by_accelerations(const Waypoints& waypoints, const Condition& start,
                                        const Condition& end) {
  KnotRing knots = measure_knots(waypoints, start.kind == ConditionKind::halt);
  if (end.kind == ConditionKind::halt) knots.halt_at_end();
  AccelerationSystem system = solved(knots, start, end);
  write_velocities(system, knots);
  PiecewisePolynomial curve(waypoints.dimensions);
  Segment segment(waypoints.dimensions);
  for (std::size_t i = 0; i < knots.newest(); ++i) {
    const Interval interval = knots.interval(i);
    build_segment(interval, segment);
    if (segment.order == kCubicOrder) {
      write_cubic_part(system.at(i), system.at(i + 1), system.h(i), segment);
    }
    write_acceleration_step(knots, i, interval, false, segment.acceleration_step);
    append(segment, curve);
  }
  return curve;
}

}  // namespace splinecast::core
