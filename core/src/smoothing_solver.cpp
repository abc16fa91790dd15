#include <algorithm>
#include <array>

#include "knot_solvers.hpp"
#include "splinecast/core/state.hpp"

namespace splinecast::core {
namespace {

/// `smoothing`. Its tail is its natural end. A condition asked for at an end does not change the
/// knots: it replaces the end's velocity by what the condition makes of its neighbour's.
class SmoothingSolver final : public KnotSolver {
 public:
  SmoothingSolver(const Interpolant& how, const Condition& start, std::size_t dimensions)
      : KnotSolver(start, dimensions), lambda_(how.lambda) {}

  void eliminate_again(KnotRing& /*knots*/) const noexcept override {}

  void push(KnotRing& knots, const Waypoint& waypoint) const noexcept override {
    knots.push(waypoint.time, waypoint.position);
    const std::size_t n = knots.newest();
    if (n == 0) std::ranges::fill(knots.values(0, KnotRing::kG), 0.0);
    if (n > 1) eliminate(knots, n - 1);
  }

  void solve(KnotRing& knots, Tail /*tail*/, std::size_t last) const noexcept override {
    if (knots.newest() == 0) {
      std::ranges::copy(knots.values(0, KnotRing::kWaypoint),
                        knots.values(0, KnotRing::kPosition).begin());
      solve_lone_knot(knots, start());
      return;
    }
    write_accelerations(knots, last == 0 ? 0 : last - 1);
    write_positions(knots, last);
    write_velocities(knots, last);
    if (last == 0 && start().kind != ConditionKind::own) impose_start(knots);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t last) const noexcept override {
    const std::size_t n = knots.newest();
    solve(knots, Tail::natural, last);
    if (n == 0 || end.kind == ConditionKind::own) return;
    if (end.kind == ConditionKind::halt) knots.halt_at_end();
    solve_last(end, knots.end_intervals(), 0, knots.values(n - 1, KnotRing::kVelocity),
               knots.values(n, KnotRing::kVelocity));
  }

 private:
  void eliminate(KnotRing& knots, std::size_t i) const noexcept {
    const std::size_t before2 = i > 1 ? i - 2 : 0;  // row 1 has none: row 0 stands in, as none too
    const SmoothingRow row =
        factor_smoothing(lambda_,
                         {.h_before2 = knots.row(before2).h,
                          .h_before = knots.row(i - 1).h,
                          .h_after = knots.row(i).h},
                         knots.row(before2).prefix.smoothing, knots.row(i - 1).prefix.smoothing);
    knots.row(i).prefix.smoothing = row;
    eliminate_smoothing(row, knots.values(i - 1, KnotRing::kChord),
                        knots.values(i, KnotRing::kChord), knots.values(before2, KnotRing::kG),
                        knots.values(i - 1, KnotRing::kG), knots.values(i, KnotRing::kG));
  }

  /// Accelerations of knots `last` to the newest; they are 0 at both ends.
  static void write_accelerations(KnotRing& knots, std::size_t last) noexcept {
    const std::size_t n = knots.newest();
    const auto a = [&](std::size_t i) { return knots.values(i, KnotRing::kAcceleration); };
    const auto row = [&](std::size_t i) {
      return i < n ? knots.row(i).prefix.smoothing : SmoothingRow{};
    };
    std::ranges::fill(a(n), 0.0);
    for (std::size_t i = n; i-- > std::max<std::size_t>(last, 1);) {
      back_substitute_smoothing(row(i), row(i + 1), row(i + 2), knots.values(i, KnotRing::kG),
                                a(i + 1), a(std::min(i + 2, n)), a(i));
    }
    if (last == 0) std::ranges::fill(a(0), 0.0);
  }

  /// Positions of knots `last` to the newest, and the chords at them.
  void write_positions(KnotRing& knots, std::size_t last) const noexcept {
    const std::size_t n = knots.newest();
    const auto a = [&](std::size_t i) { return knots.values(i, KnotRing::kAcceleration); };
    for (std::size_t i = last; i <= n; ++i) {
      smooth_position(lambda_, i > 0 ? knots.row(i - 1).h : 0, i < n ? knots.row(i).h : 0,
                      knots.values(i, KnotRing::kWaypoint), a(i > 0 ? i - 1 : 0), a(i),
                      a(std::min(i + 1, n)), knots.values(i, KnotRing::kPosition));
    }
    for (std::size_t i = last == 0 ? 0 : last - 1; i < n; ++i) {
      write_chord(knots.position(i), knots.position(i + 1), knots.row(i).h,
                  knots.values(i, KnotRing::kPositionChord));
    }
  }

  /// Velocities of knots `last` to the newest, from positions and accelerations (doc 003 eq 4-8).
  static void write_velocities(KnotRing& knots, std::size_t last) noexcept {
    const std::size_t n = knots.newest();
    for (std::size_t i = last; i <= n; ++i) {
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

  void impose_start(KnotRing& knots) const noexcept {
    std::array<double, kMaxDimensions> values{};
    const auto g = std::span(values).first(knots.dimensions());
    const double gamma = eliminate_first(start(), knots.start_intervals(), g);
    back_substitute(gamma, g, knots.values(1, KnotRing::kVelocity),
                    knots.values(0, KnotRing::kVelocity));
  }

  double lambda_;
};

}  // namespace

std::unique_ptr<KnotSolver> make_smoothing_solver(const Interpolant& how, const Condition& start,
                                                  std::size_t dimensions) {
  return std::make_unique<SmoothingSolver>(how, start, dimensions);
}

}  // namespace splinecast::core
