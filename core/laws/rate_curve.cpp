#include "core/laws/rate_curve.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::core {
namespace {

/// The least value in [0, 1] of the cubic with these values and derivatives at 0 and 1.
double least_of_cubic(double d0, double m0, double d1, double m1) noexcept {
  double least = std::min(d0, d1);
  // The cubic is within the hull of its Bézier points.
  if (std::min(d0 + m0 / 3, d1 - m1 / 3) >= least) return least;
  const double c2 = 3 * (d1 - d0) - 2 * m0 - m1;
  const double c3 = 2 * (d0 - d1) + m0 + m1;
  const auto try_at = [&](double u) {
    if (u > 0 && u < 1) least = std::min(least, d0 + u * (m0 + u * (c2 + u * c3)));
  };
  // Roots of m0 + 2 c2 u + 3 c3 u², without cancellation.
  const double discriminant = c2 * c2 - 3 * c3 * m0;
  if (discriminant < 0) return least;
  const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
  if (q != 0) try_at(m0 / q);
  if (c3 != 0) try_at(q / (3 * c3));
  return least;
}

}  // namespace

LawState end_of_piece(const LawState& from, double rate, Time length) noexcept {
  const double h = to_seconds(length);
  return {.time = from.time + length,
          .position = from.position + (h * (from.rate + rate) / 2 + h * h * from.slope / 12),
          .rate = rate,
          .slope = 0};
}

RateState RatePiece::at(Time time) const noexcept {
  const double h = to_seconds(length);
  const double u = std::clamp(to_seconds(time - begin) / h, 0.0, 1.0);
  const double w = 1 - u;
  const double change = end_rate - from.rate;
  return {.rate = from.rate + h * from.slope * u * w * w + change * u * u * (3 - 2 * u),
          .slope = w * (from.slope * (1 - 3 * u) + 6 * change * u / h)};
}

double RatePiece::steepest() const noexcept {
  // The slope is the parabola with slope 0 at the end; its extreme is in between.
  const double chord = 6 * (end_rate - from.rate) / to_seconds(length);
  const double bend = chord - 3 * from.slope;  // slope(u) = (1 - u)(from.slope + bend·u)
  double most = std::abs(from.slope);
  const double u = bend != 0 ? (bend - from.slope) / (2 * bend) : 0;
  if (u > 0 && u < 1) most = std::max(most, std::abs((1 - u) * (from.slope + bend * u)));
  return most;
}

void RateCurve::add(double end_rate, Time length) noexcept {
  const bool is_first = count_ == 0;
  pieces_[count_] = {.begin = end(),
                     .length = length,
                     .from = is_first ? from_ : RateState{last_rate_, 0},
                     .end_rate = end_rate};
  ++count_;
  last_rate_ = end_rate;
}

RateCurve::Part RateCurve::part_at(Time time) const noexcept {
  if (count_ > 0 && time < pieces_[0].begin) {
    return {.rate = pieces_[0].from.rate, .end = pieces_[0].begin};
  }
  for (const RatePiece& piece : pieces()) {
    if (time < piece.end()) return {.piece = &piece, .end = piece.end()};
  }
  return {.rate = last_rate_};
}

RateState RateCurve::at(Time time) const noexcept { return part_at(time).at(time); }

double RateCurve::steepest() const noexcept {
  double most = 0;
  for (const RatePiece& piece : pieces()) most = std::max(most, piece.steepest());
  return most;
}

double largest_excess(const RateCurve& curve, const RateCurve& bound, Time from) noexcept {
  double least = bound.at(from).rate - curve.at(from).rate;
  // Each turn passes the end of a part.
  for (Time t = from; t < Time::max();) {
    const RateCurve::Part low = curve.part_at(t);
    const RateCurve::Part high = bound.part_at(t);
    const Time end = std::min(low.end, high.end);
    if (end == Time::max()) return -std::min(least, high.rate - low.rate);
    const double h = to_seconds(end - t);
    const auto difference = [&](Time at) {
      const RateState a = low.at(at);
      const RateState b = high.at(at);
      return RateState{b.rate - a.rate, h * (b.slope - a.slope)};
    };
    const RateState left = difference(t);
    const RateState right = difference(end);
    least = std::min(least, least_of_cubic(left.rate, left.slope, right.rate, right.slope));
    t = end;
  }
  return -least;
}

}  // namespace splinecast::core
