#pragma once

#include "core/slopes/rule.hpp"
#include "splinecast/boundary_condition.hpp"

/// The rows of tridiagonal_system.hpp in one dimension or several at once.
namespace splinecast::core {

/// The part of an interior row that all dimensions share: lengths of the intervals around its knot,
/// and its pivot after elimination.
struct InteriorRow {
  double before;
  double after;
  double pivot;

  InteriorRow(double h_before, double h_after, double gamma_before) noexcept
      : before(h_before),
        after(h_after),
        pivot(2 * (h_before + h_after) - h_after * gamma_before) {}

  [[nodiscard]] double gamma() const noexcept { return before / pivot; }
  template <typename Lane>
  [[nodiscard, gnu::always_inline]] Lane g(Lane m_before, Lane m_after,
                                           Lane g_before) const noexcept {
    const Lane right_side = 3.0 * (after * m_before + before * m_after);
    return (right_side - after * g_before) / pivot;
  }
};

/// The part of the newest row that all dimensions share while a stream continues: lengths of the
/// last interval and of the one before it, and γ of the row before. Without an interval before, any
/// length is valid, except for Tail::bessel, which needs this interval.
class TailRow {
 public:
  TailRow(Tail tail, double h, double h_next, double gamma_before) noexcept
      : tail_(tail),
        slope_(tail == Tail::natural ? 3 : 2),
        scale_(tail == Tail::bessel ? parabola_weight(h, h_next) : slope_ - 1 - gamma_before) {}

  /// From the chord slopes of these intervals and g of the row before.
  template <typename Lane>
  [[nodiscard, gnu::always_inline]] Lane velocity(Lane m, Lane m_next,
                                                  Lane g_before) const noexcept {
    if (tail_ == Tail::bessel) return m + scale_ * (m - m_next);
    if (tail_ == Tail::clamped) return Lane{};
    return (slope_ * m - g_before) / scale_;
  }

 private:
  Tail tail_;
  double slope_;
  double scale_;  ///< bessel: weight of the change of slope; else the pivot
};

}  // namespace splinecast::core
