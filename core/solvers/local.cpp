#include <algorithm>
#include <cmath>
#include <limits>

#include "core/slopes/rule.hpp"
#include "core/solvers/families.hpp"

namespace splinecast::core {
namespace {

const SlopeRule& rule_of(const Interpolant& how) noexcept {
  return *procedure_of(*how.method).rule;
}

/// Rows of a slope rule: with γ = 0 they need no elimination.
class LocalSolver final : public KnotSolver {
 public:
  LocalSolver(const Interpolant& how, const Condition& start, std::size_t dimensions)
      : KnotSolver(
            start.kind == ConditionKind::own && rule_of(how).natural_end ? Condition{} : start,
            dimensions),
        rule_(&rule_of(how)),
        scale_(how.time_scale) {}

  void eliminate_again(KnotRing& knots) const noexcept override {
    if (knots.size() > 1) eliminate_start(knots);
  }

  void push(KnotRing& knots, const Waypoint& waypoint) const noexcept override {
    knots.push(waypoint.time, waypoint.position);
    const std::size_t n = knots.newest();
    if (n == 0) {
      solve_lone_knot(knots, start());
      return;
    }
    if (n <= 2) eliminate_start(knots);  // the second interval may change the start's slope
    const auto ahead = static_cast<std::size_t>(rule_->ahead);
    for (std::size_t i = std::max<std::size_t>(n - std::min(n, ahead), 1); i < n; ++i) {
      write_slope(knots, i, knots.values(i, KnotRing::kG));
    }
  }

  void solve(KnotRing& knots, Tail tail, std::size_t first) const noexcept override {
    if (knots.newest() == 0) return;
    close(knots, tail);
    back_substitute_to(knots, first);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t first) const noexcept override {
    const std::size_t n = knots.newest();
    if (n == 0) return;
    if (end.kind == ConditionKind::own && !rule_->natural_end) {
      write_own_end(knots, n, knots.end_intervals(), knots.values(n, KnotRing::kVelocity));
    } else {
      close(knots, end);
    }
    back_substitute_to(knots, first);
  }

 private:
  void eliminate_start(KnotRing& knots) const noexcept {
    const auto g = knots.values(0, KnotRing::kG);
    if (start().kind == ConditionKind::own) {
      write_own_end(knots, 0, knots.start_intervals(), g);
    } else {
      knots.gamma(0) = eliminate_first(start(), knots.start_intervals(), g);
    }
  }

  /// The rule's own slope at an end knot; with one interval only, its chord slope.
  void write_own_end(const KnotRing& knots, std::size_t i, const EndIntervals& at,
                     std::span<double> v) const noexcept {
    if (at.h_next == 0) {
      std::ranges::copy(at.chord, v.begin());
    } else if (rule_->end_slope == nullptr) {
      write_slope(knots, i, v);
    } else {
      for (std::size_t d = 0; d < v.size(); ++d) {
        v[d] = rule_->end_slope({at.h, at.chord[d], at.h_next, at.chord_next[d]});
      }
    }
  }

  void write_slope(const KnotRing& knots, std::size_t i, std::span<double> v) const noexcept {
    Stencil stencil(scale_);
    for (std::size_t d = 0; d < v.size(); ++d) {
      fill(knots, i, d, stencil);
      v[d] = rule_->slope(stencil);
    }
  }

  /// Fills the intervals around knot i. Beyond an end, extrapolates the chord slopes linearly from
  /// the last two (math 13), or repeats the only one.
  void fill(const KnotRing& knots, std::size_t i, std::size_t d, Stencil& out) const noexcept {
    const int before = static_cast<int>(std::min<std::size_t>(i, kMaxReach));
    const int after = static_cast<int>(std::min<std::size_t>(knots.newest() - i, kMaxReach));
    const int first = -std::min(before, std::max(rule_->before, 2));
    const int last = std::min(after, std::max(rule_->ahead, 2));
    for (int k = first; k < last; ++k) {
      const std::size_t interval = i + static_cast<std::size_t>(k);
      const double h = knots.row(interval).h;
      const double x = std::max(std::abs(knots.position(interval)[d]),
                                std::abs(knots.position(interval + 1)[d]));
      out.set(k, h, knots.chord(interval)[d], std::numeric_limits<double>::epsilon() * x / h);
    }
    for (int k = after; k < rule_->ahead; ++k) {
      extend(out, k, k - 1, k - 2 >= -before ? k - 2 : k - 1);
    }
    for (int k = -before - 1; k >= -rule_->before; --k) {
      extend(out, k, k + 1, k + 2 < after ? k + 2 : k + 1);
    }
  }

  /// Extrapolates the chord slopes of the intervals `inner` and `next` to interval k.
  static void extend(Stencil& out, int k, int next, int inner) noexcept {
    out.set(k, out.h(next), 2 * out.m(next) - out.m(inner),
            2 * out.rounding(next) + out.rounding(inner));
  }

  const SlopeRule* rule_;
  double scale_;
};

}  // namespace

std::unique_ptr<KnotSolver> make_local_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use /*use*/) {
  return std::make_unique<LocalSolver>(how, start, dimensions);
}

}  // namespace splinecast::core
