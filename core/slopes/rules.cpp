#include <algorithm>
#include <array>
#include <cmath>

#include "core/slopes/rule.hpp"

// A rule is its formula and a line of the registry at the end of this file.
namespace splinecast::core {
namespace {

/// The slope of the parabola through the knot and its neighbours (math 8).
double bessel(const Stencil& s) noexcept {
  return (s.h(0) * s.m(-1) + s.h(-1) * s.m(0)) / (s.h(-1) + s.h(0));
}

double bessel_end(const EndStencil& s) noexcept { return parabola_end_slope(s); }

/// The share of the weighted mean in the slope, from 0 to 1. `sum` is the sum of the weights,
/// `rounding` its rounding error. The share is 0 if the sum is only rounding, and exactly 1 from
/// about 3,000 times the rounding on. It is smooth in between: at a threshold, rounding would
/// decide.
double share_of_weights(double sum, double rounding) noexcept {
  constexpr double kLarge = 32;
  const double z = sum / (kLarge * rounding);
  const double z2 = z * z;
  const double z4 = z2 * z2;
  const double z8 = z4 * z4;  // finite: sums are at most a few 1/ε times their rounding
  return z8 / (1 + z8);
}

/// The mean of the neighbouring chord slopes, each weighted by the variation of the slopes on the
/// other side. Blends into `without_weights` if the weights are only rounding errors of the chord
/// slopes.
double weighted(const Stencil& s, double before, double after, double without_weights) noexcept {
  const double sum = after + before;
  double rounding = 0;
  for (int k = -2; k < 2; ++k) rounding += s.rounding(k);
  if (sum == 0 || rounding == 0) return without_weights;
  const double share = share_of_weights(sum, rounding);
  const double mean = after / sum * s.m(-1) + before / sum * s.m(0);
  return share * mean + (1 - share) * without_weights;
}

/// Akima's rule (math 9).
double akima(const Stencil& s) noexcept {
  const double before = std::abs(s.m(-1) - s.m(-2));
  const double after = std::abs(s.m(1) - s.m(0));
  return weighted(s, before, after, (s.m(-1) + s.m(0)) / 2);
}

/// Akima's rule with weights that do not vanish if the chord slopes are constant, and slope 0 on a
/// plateau.
double makima(const Stencil& s) noexcept {
  const auto weight = [&s](int k) {
    return std::abs(s.m(k) - s.m(k - 1)) + std::abs(s.m(k) + s.m(k - 1)) / 2;
  };
  return weighted(s, weight(-1), weight(1), 0);
}

int sign(double x) noexcept { return static_cast<int>(x > 0) - static_cast<int>(x < 0); }

/// Fritsch and Carlson: a weighted harmonic mean, so that the curve is monotone where its waypoints
/// are.
double pchip(const Stencil& s) noexcept {
  if (sign(s.m(-1)) * sign(s.m(0)) <= 0) return 0;
  const double w1 = 2 * s.h(0) + s.h(-1);
  const double w2 = s.h(0) + 2 * s.h(-1);
  return (w1 + w2) / (w1 / s.m(-1) + w2 / s.m(0));
}

/// The slope of the parabola, limited so that the end interval is monotone.
double pchip_end(const EndStencil& s) noexcept {
  const double slope = ((2 * s.h0 + s.h1) * s.m0 - s.h0 * s.m1) / (s.h0 + s.h1);
  if (sign(slope) != sign(s.m0)) return 0;
  if (sign(s.m0) != sign(s.m1) && std::abs(slope) > 3 * std::abs(s.m0)) return 3 * s.m0;
  return slope;
}

/// Normal to the bisector of the angle between the two chords in the plane of time and position
/// (math 12).
double rounded(const Stencil& s) noexcept {
  const auto length_per_h = [&s](int k) {
    return std::sqrt(1 / (s.scale() * s.scale()) + s.m(k) * s.m(k));
  };
  const double before = length_per_h(-1);
  const double after = length_per_h(0);
  return (s.m(0) / after + s.m(-1) / before) / (1 / after + 1 / before);
}

constexpr std::array kRules{
    SlopeRule{.name = "bessel",
              .number = 16,
              .before = 1,
              .ahead = 1,
              .slope = bessel,
              .end_slope = bessel_end,
              .natural_end = false,
              .laws = {.continuity = 1, .degree = 2, .order_of_convergence = 3}},
    SlopeRule{
        .name = "akima",
        .number = 17,
        .before = 2,
        .ahead = 2,
        .slope = akima,
        .end_slope = nullptr,
        .natural_end = false,
        .laws = {.continuity = 1, .degree = 1, .order_of_convergence = 3, .is_linear = false}},
    SlopeRule{
        .name = "makima",
        .number = 18,
        .before = 2,
        .ahead = 2,
        .slope = makima,
        .end_slope = nullptr,
        .natural_end = false,
        .laws = {.continuity = 1, .degree = 1, .order_of_convergence = 3, .is_linear = false}},
    SlopeRule{
        .name = "pchip",
        .number = 19,
        .before = 1,
        .ahead = 1,
        .slope = pchip,
        .end_slope = pchip_end,
        .natural_end = false,
        .laws = {.continuity = 1, .degree = 1, .order_of_convergence = 3, .is_linear = false}},
    SlopeRule{.name = "rounded",
              .number = 20,
              .before = 1,
              .ahead = 1,
              .slope = rounded,
              .end_slope = nullptr,
              .natural_end = true,
              .laws = {.continuity = 1,
                       .degree = 1,
                       .order_of_convergence = 3,
                       .is_linear = false,
                       .is_scale_free = false}},
};

}  // namespace

std::span<const SlopeRule> slope_rules() noexcept { return kRules; }

}  // namespace splinecast::core
