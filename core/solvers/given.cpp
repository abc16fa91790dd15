#include <algorithm>
#include <utility>

#include "core/solvers/families.hpp"

namespace splinecast::core {
namespace {

/// `hermite` and `quintic`: the values given with the waypoints are the solution; a boundary
/// condition overrides them at its end.
class GivenSolver final : public KnotSolver {
 public:
  GivenSolver(const Interpolant& how, const Condition& start, std::size_t dimensions)
      : KnotSolver(start, dimensions), has_accelerations_(how.method->needs_acceleration()) {}

  void eliminate_again(KnotRing& /*knots*/) const noexcept override {}

  void push(KnotRing& knots, const Waypoint& waypoint) const noexcept override {
    knots.push(waypoint.time, waypoint.position);
    const std::size_t n = knots.newest();
    std::ranges::copy(waypoint.velocity, knots.values(n, KnotRing::kVelocity).begin());
    if (has_accelerations_) {
      std::ranges::copy(waypoint.acceleration, knots.values(n, KnotRing::kAcceleration).begin());
    }
    if (n == 0) impose(knots, start(), 0);
    std::ranges::copy(knots.values(n, KnotRing::kVelocity), knots.values(n, KnotRing::kG).begin());
    if (n == 1 && !has_accelerations_ && start().kind != ConditionKind::own) {
      knots.gamma(0) =
          eliminate_first(start(), knots.start_intervals(), knots.values(0, KnotRing::kG));
    }
  }

  void solve(KnotRing& knots, Tail /*tail*/, std::size_t first) const noexcept override {
    back_substitute_to(knots, first);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t first) const noexcept override {
    const std::size_t n = knots.newest();
    if (n == 0) return;
    if (has_accelerations_) {
      impose(knots, end, n);
    } else if (end.kind != ConditionKind::own) {
      close(knots, end);
    }
    back_substitute_to(knots, first);
  }

 private:
  /// Replaces the given values at knot i by those of the condition.
  void impose(KnotRing& knots, const Condition& condition, std::size_t i) const noexcept {
    const auto kind = condition.kind;
    const bool rests = kind == ConditionKind::clamped || kind == ConditionKind::halt;
    const auto v = knots.values(i, KnotRing::kVelocity);
    if (rests) std::ranges::fill(v, 0.0);
    if (kind == ConditionKind::velocity) std::ranges::copy(condition.value, v.begin());
    if (!has_accelerations_) return;
    const auto a = knots.values(i, KnotRing::kAcceleration);
    if (kind == ConditionKind::natural || kind == ConditionKind::halt) std::ranges::fill(a, 0.0);
    if (kind == ConditionKind::acceleration) std::ranges::copy(condition.value, a.begin());
  }

  bool has_accelerations_;
};

}  // namespace

std::unique_ptr<KnotSolver> make_given_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use /*use*/) {
  return std::make_unique<GivenSolver>(how, start, dimensions);
}

}  // namespace splinecast::core
