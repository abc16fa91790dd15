#include <algorithm>
#include <array>
#include <utility>

#include "core/solvers/families.hpp"
#include "core/solvers/smoothing_mesh.hpp"
#include "core/solvers/smoothing_system.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

/// `smoothing`. Its condition at the newest knot is natural. A boundary condition does not move the
/// knots: it only replaces the velocity at its end, which is solved from the velocity of the
/// neighbouring knot.
class SmoothingSolver final : public KnotSolver {
 public:
  SmoothingSolver(const Interpolant& how, const Condition& start, std::size_t dimensions, Use use)
      : KnotSolver(start, dimensions), lambda_(how.lambda), use_(use) {}

  void eliminate_again(KnotRing& /*knots*/) const noexcept override {}

  void push(KnotRing& knots, const Waypoint& waypoint) const noexcept override {
    knots.push(waypoint.time, waypoint.position);
    const std::size_t n = knots.newest();
    if (n == 0) std::ranges::fill(knots.values(0, KnotRing::kG), 0.0);
    if (n > 1 && use_ == Use::online) eliminate(knots, n - 1);
  }

  void solve(KnotRing& knots, Tail /*tail*/, std::size_t first) const noexcept override {
    solve(knots, Condition{.kind = ConditionKind::own, .value = {}}, first);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t first) const noexcept override {
    if (knots.newest() == 0) {
      std::ranges::fill(knots.values(0, KnotRing::kResidual), 0.0);
      write_positions(knots, 0);
      solve_lone_knot(knots, start());
      return;
    }
    if (use_ == Use::at_once) {
      solve_at_once(knots);
    } else {
      write_accelerations(knots, first == 0 ? 0 : first - 1);
      write_residuals(knots, first);
      write_chords(knots, first == 0 ? 0 : first - 1);
    }
    write_positions(knots, first);
    write_velocities(knots, first);
    impose_ends(knots, end, first);
  }

 private:
  void eliminate(KnotRing& knots, std::size_t i) const noexcept {
    const std::size_t before2 = i > 1 ? i - 2 : 0;  // row 1 has no row −1: uses the empty row 0
    const SmoothingIntervals at = smoothing_intervals(knots, i);
    const SmoothingRow row = factor_smoothing(lambda_, at, roughness_row<double>(at),
                                              knots.smoothing(before2), knots.smoothing(i - 1));
    knots.smoothing(i) = row;
    const auto chord_before = knots.values(i - 1, KnotRing::kChord);
    const auto chord_after = knots.values(i, KnotRing::kChord);
    const auto z_before2 = knots.values(before2, KnotRing::kG);
    const auto z_before = knots.values(i - 1, KnotRing::kG);
    const auto z = knots.values(i, KnotRing::kG);
    for (std::size_t d = 0; d < z.size(); ++d) {
      z[d] = eliminate_smoothing(row, chord_before[d], chord_after[d], z_before2[d], z_before[d]);
    }
  }

  /// Writes the accelerations of knots `first` to the newest; they are 0 at both ends.
  static void write_accelerations(KnotRing& knots, std::size_t first) noexcept {
    const std::size_t n = knots.newest();
    const auto a = [&](std::size_t i) { return knots.values(i, KnotRing::kAcceleration); };
    const auto row = [&](std::size_t i) { return i < n ? knots.smoothing(i) : SmoothingRow{}; };
    std::ranges::fill(a(n), 0.0);
    for (std::size_t i = n; i-- > std::max<std::size_t>(first, 1);) {
      const auto z = knots.values(i, KnotRing::kG);
      for (std::size_t d = 0; d < z.size(); ++d) {
        a(i)[d] = back_substitute_smoothing(row(i), row(i + 1), row(i + 2), z[d], a(i + 1)[d],
                                            a(std::min(i + 2, n))[d]);
      }
    }
    if (first == 0) std::ranges::fill(a(0), 0.0);
  }

  void write_residuals(KnotRing& knots, std::size_t first) const noexcept {
    const std::size_t n = knots.newest();
    const auto a = [&](std::size_t i) { return knots.values(i, KnotRing::kAcceleration); };
    for (std::size_t i = first; i <= n; ++i) {
      const auto residual = knots.values(i, KnotRing::kResidual);
      for (std::size_t d = 0; d < residual.size(); ++d) {
        residual[d] =
            smoothing_residual(lambda_, i > 0 ? knots.row(i - 1).h : 0, i < n ? knots.row(i).h : 0,
                               a(i > 0 ? i - 1 : 0)[d], a(i)[d], a(std::min(i + 1, n))[d]);
      }
    }
  }

  /// Writes the chord slopes of the smoothed curve from interval `first` to the last one.
  static void write_chords(KnotRing& knots, std::size_t first) noexcept {
    for (std::size_t i = first; i < knots.newest(); ++i) knots.measure_smoothed(i);
  }

  static void write_positions(KnotRing& knots, std::size_t first) noexcept {
    for (std::size_t i = first; i <= knots.newest(); ++i) {
      const auto x = knots.values(i, KnotRing::kWaypoint);
      const auto residual = knots.values(i, KnotRing::kResidual);
      const auto position = knots.values(i, KnotRing::kPosition);
      for (std::size_t d = 0; d < x.size(); ++d) position[d] = x[d] - residual[d];
    }
  }

  /// Writes the accelerations, residuals and chord slopes of all knots.
  void solve_at_once(KnotRing& knots) const {
    const std::size_t n = knots.newest();
    const SmoothingMesh mesh(knots);
    const BatchSmoothing system(mesh, lambda_);
    for (std::size_t d = 0; d < knots.dimensions(); ++d) {
      const auto [a, residual] = system.solve(d);
      for (std::size_t i = 0; i <= n; ++i) {
        knots.values(i, KnotRing::kAcceleration)[d] = static_cast<double>(a[i]);
        knots.values(i, KnotRing::kResidual)[d] = static_cast<double>(residual[i]);
        if (i == n) continue;
        knots.values(i, KnotRing::kPositionChord)[d] = static_cast<double>(smoothed_chord(
            knots.values(i, KnotRing::kChord)[d], knots.row(i).h, residual[i], residual[i + 1]));
      }
    }
  }

  /// Writes the velocities of knots `first` to the newest, from chords and accelerations (math 3).
  static void write_velocities(KnotRing& knots, std::size_t first) noexcept {
    const std::size_t n = knots.newest();
    for (std::size_t i = first; i <= n; ++i) {
      const std::size_t interval = std::min(i, n - 1);
      // From the right end of an interval the same formula holds with h < 0.
      const double h = i < n ? knots.row(interval).h : -knots.row(interval).h;
      const auto chord = knots.chord(interval);
      const auto a = knots.values(i, KnotRing::kAcceleration);
      const auto a_other = knots.values(i < n ? i + 1 : n - 1, KnotRing::kAcceleration);
      const auto v = knots.values(i, KnotRing::kVelocity);
      for (std::size_t d = 0; d < v.size(); ++d) {
        v[d] = chord[d] - h * (2 * a[d] + a_other[d]) / 6;
      }
    }
  }

  /// Replaces the velocities at the ends that have a boundary condition. With two knots, each end
  /// is the neighbour of the other: they are solved together.
  void impose_ends(KnotRing& knots, const Condition& end, std::size_t first) const noexcept {
    const std::size_t n = knots.newest();
    const auto v = [&](std::size_t i) { return knots.values(i, KnotRing::kVelocity); };
    std::array<double, kMaxDimensions> values{};
    const auto g = std::span(values).first(knots.dimensions());
    const bool imposes_start = first == 0 && start().kind != ConditionKind::own;
    double gamma = 0;
    std::ranges::copy(v(n == 1 ? 0 : n - 1), g.begin());
    if (end.kind == ConditionKind::halt) knots.halt_at_end();
    if (n == 1 && imposes_start) gamma = eliminate_first(start(), knots.start_intervals(), g);
    if (end.kind != ConditionKind::own || (n == 1 && imposes_start)) {
      solve_last(end, knots.end_intervals(), gamma, g, v(n));
    }
    if (!imposes_start) return;
    if (n > 1) gamma = eliminate_first(start(), knots.start_intervals(), g);
    back_substitute(gamma, g, v(1), v(0));
  }

  double lambda_;
  Use use_;
};

}  // namespace

std::unique_ptr<KnotSolver> make_smoothing_solver(const Interpolant& how, const Condition& start,
                                                  std::size_t dimensions, Use use) {
  return std::make_unique<SmoothingSolver>(how, start, dimensions, use);
}

}  // namespace splinecast::core
