#include "core/polynomial/roots.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::core {
namespace {

/// Distance of neighbouring doubles below 1: the resolution of a root.
constexpr double kResolution = 0x1p-53;

/// An end of a bracket.
struct End {
  double s = 0;
  double value = 0;
};

void add(Roots& roots, double s) noexcept {
  if (roots.count == 0 || s > roots.values[roots.count - 1]) roots.values[roots.count++] = s;
}

/// The root of a quadratic between two ends of different sign. Computes both roots, the first from
/// the sum without cancellation, the second from their product, and returns the one between the
/// ends.
double quadratic_root(std::span<const double> c, const End& low, const End& high) noexcept {
  const double discriminant = std::max(c[1] * c[1] - 4 * c[0] * c[2], 0.0);
  const double q = -(c[1] + std::copysign(std::sqrt(discriminant), c[1])) / 2;
  const double first = std::clamp(q / c[2], low.s, high.s);
  const double second = std::clamp(c[0] / q, low.s, high.s);
  return std::abs(first - q / c[2]) <= std::abs(second - c[0] / q) ? first : second;
}

double slope_at(std::span<const double> c, double s) noexcept {
  double slope = 0;
  for (std::size_t k = c.size() - 1; k > 0; --k) slope = slope * s + static_cast<double>(k) * c[k];
  return slope;
}

/// Moves one end of the bracket to s: the end whose value has the sign of the value at s.
void narrow(std::span<const double> c, double s, End& low, End& high) noexcept {
  const double value = value_at(c, s);
  (std::signbit(value) == std::signbit(low.value) ? low : high) = {s, value};
}

/// The root between two ends of different sign. Takes Newton's steps from the better end if they
/// stay inside. Each round also halves the bracket, so that 64 rounds are always enough.
double bracketed_root(std::span<const double> c, End low, End high) noexcept {
  for (int round = 0; round < 64 && high.s - low.s > kResolution; ++round) {
    const End better = std::abs(low.value) < std::abs(high.value) ? low : high;
    const double step = better.value / slope_at(c, better.s);
    if (std::abs(step) <= kResolution) return better.s;
    const double newton = better.s - step;
    if (newton > low.s && newton < high.s) narrow(c, newton, low, high);
    narrow(c, low.s + (high.s - low.s) / 2, low, high);
  }
  return std::abs(low.value) < std::abs(high.value) ? low.s : high.s;
}

double root_between(std::span<const double> c, const End& low, const End& high) noexcept {
  if (c.size() == 2) return std::clamp(-c[0] / c[1], low.s, high.s);
  if (c.size() == 3) return quadratic_root(c, low, high);
  return bracketed_root(c, low, high);
}

/// The ends of the monotone pieces of a polynomial: the roots of its derivative, and 1.
Roots piece_ends(std::span<const double> c) noexcept {
  std::array<double, kMaxRootCoefficients> slopes{};
  for (std::size_t k = 1; k < c.size(); ++k) slopes[k - 1] = static_cast<double>(k) * c[k];
  Roots ends = unit_roots(std::span(slopes).first(c.size() - 1));
  add(ends, 1);
  return ends;
}

}  // namespace

double value_at(std::span<const double> c, double s) noexcept {
  double value = 0;
  for (std::size_t k = c.size(); k-- > 0;) value = value * s + c[k];
  return value;
}

Roots unit_roots(std::span<const double> c) noexcept {
  while (!c.empty() && c.back() == 0) c = c.first(c.size() - 1);
  Roots roots;
  if (c.size() < 2) return roots;
  const auto is_root = [](const End& end) { return end.value == 0; };
  End low{.s = 0, .value = c[0]};
  if (is_root(low)) add(roots, 0);
  for (const double s : piece_ends(c)) {
    const End high{.s = s, .value = value_at(c, s)};
    if (is_root(high)) {
      add(roots, s);
    } else if (!is_root(low) && std::signbit(low.value) != std::signbit(high.value)) {
      add(roots, root_between(c, low, high));
    }
    low = high;
  }
  return roots;
}

}  // namespace splinecast::core
