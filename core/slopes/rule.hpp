#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "splinecast/method.hpp"

/// Slope rules: the local methods. Each finds a knot's velocity from a few intervals around it.
namespace splinecast::core {

/// Largest number of intervals that a rule may use on either side of a knot.
inline constexpr int kMaxReach = 4;

/// The intervals around a knot in one dimension. Interval 0 follows the knot, interval −1 precedes
/// it.
class Stencil {
 public:
  explicit Stencil(double scale) : scale_(scale) {}

  /// Length in seconds and chord slope of interval k, for −`before` ≤ k < `ahead` of the rule.
  [[nodiscard]] double h(int k) const noexcept { return h_[index(k)]; }
  [[nodiscard]] double m(int k) const noexcept { return m_[index(k)]; }
  /// Rounding error of the chord slope of interval k, to a factor of about 3: ε·|x|/h, with the
  /// larger of the positions at its ends.
  [[nodiscard]] double rounding(int k) const noexcept { return rounding_[index(k)]; }
  void set(int k, double h, double m, double rounding) noexcept {
    h_[index(k)] = h;
    m_[index(k)] = m;
    rounding_[index(k)] = rounding;
  }

  /// Seconds that count as much as one unit of position.
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  static constexpr std::size_t kIntervals = std::size_t{2} * kMaxReach;
  static std::size_t index(int k) noexcept {
    return static_cast<std::size_t>(std::ptrdiff_t{k} + kMaxReach);
  }

  double scale_;
  std::array<double, kIntervals> h_{};
  std::array<double, kIntervals> m_{};
  std::array<double, kIntervals> rounding_{};
};

/// The two intervals at an end in one dimension, inwards: the end interval, then the next.
struct EndStencil {
  double h0, m0;
  double h1, m1;
};

/// The weight w with which the parabola through the three end knots has the slope m0 + w·(m0 − m1)
/// at the end.
[[nodiscard]] constexpr double parabola_weight(double h0, double h1) noexcept {
  return h0 / (h1 + h0);
}

/// The slope at the end of the parabola through the three end knots.
[[nodiscard]] constexpr double parabola_end_slope(const EndStencil& s) noexcept {
  return s.m0 + parabola_weight(s.h0, s.h1) * (s.m0 - s.m1);
}

/// A local method. A rule is odd in the chord slopes and symmetric in time, so that one end formula
/// serves both ends.
struct SlopeRule {
  std::string_view name;
  std::uint64_t number;  ///< identifies the rule in shared memory; never reused
  int before;            ///< knots it uses before the knot, 1 … kMaxReach
  int ahead;             ///< knots it uses after the knot, 1 … kMaxReach: its settle lag
  double (*slope)(const Stencil&) noexcept;

  /// The slope at an end knot. If null, `natural_end` selects zero acceleration at the end;
  /// otherwise `slope` is used, with the chord slopes extrapolated linearly beyond the end.
  double (*end_slope)(const EndStencil&) noexcept;
  bool natural_end;
  Laws laws;
};

/// All rules.
[[nodiscard]] std::span<const SlopeRule> slope_rules() noexcept;

}  // namespace splinecast::core
