#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>

#include "splinecast/b_spline.hpp"

namespace splinecast {
namespace {

void require_knots(const BSpline& spline) {
  if (spline.degree < 0 || spline.degree >= kMaxPolynomialOrder) {
    throw std::invalid_argument("degree must be 0 to 15, not " + std::to_string(spline.degree));
  }
  const std::size_t dimensions = spline.dimensions;
  const std::size_t values = spline.control_points.size();
  if (dimensions == 0 || values % dimensions != 0 ||
      spline.knots.size() != values / dimensions + static_cast<std::size_t>(spline.degree) + 1) {
    throw std::invalid_argument(
        std::to_string(spline.knots.size()) + " knots and " + std::to_string(values) +
        " control point values do not make a B-spline of degree " + std::to_string(spline.degree) +
        " and " + std::to_string(dimensions) + " dimensions");
  }
  const auto falls = std::ranges::adjacent_find(spline.knots, std::greater{});
  if (falls == spline.knots.end()) return;
  throw std::invalid_argument("knot " + std::to_string(falls - spline.knots.begin() + 1) + ", " +
                              std::to_string((falls + 1)->count()) + " ns, is before " +
                              std::to_string(falls->count()) + " ns");
}

/// The polynomial on the interval after knot j, from its derivatives at that knot. The r-th
/// derivative is De Boor's algorithm on r-fold differences of the control points. Each difference
/// is divided by a knot span that covers several intervals. (Bézier points of the interval would be
/// exact too, but their differences are divided by the length of this interval, which may be
/// short.)
class LocalPolynomial {
 public:
  LocalPolynomial(const BSpline& spline, std::size_t j)
      : spline_(spline), j_(j), dimensions_(spline.dimensions) {
    const auto first =
        spline.control_points.begin() + static_cast<std::ptrdiff_t>((j - degree()) * dimensions_);
    points_.assign(first, first + static_cast<std::ptrdiff_t>((degree() + 1) * dimensions_));
  }

  /// Coefficients [power][dimension] in seconds from knot j. Overwrites the control points.
  std::vector<double> coefficients() {
    std::vector<double> result;
    double factorial = 1;
    for (std::size_t r = 0; r <= degree(); ++r) {
      if (r > 0) {
        difference(r);
        factorial *= static_cast<double>(r);
      }
      for (const double x : value(r)) result.push_back(x / factorial);
    }
    return result;
  }

 private:
  [[nodiscard]] std::size_t degree() const { return static_cast<std::size_t>(spline_.degree); }

  /// The denominator of step `steps` of De Boor's algorithm for points i − 1 and i: the length, in
  /// seconds, of the knot span on which both depend.
  [[nodiscard]] double span(std::size_t i, std::size_t steps) const {
    return to_seconds(spline_.knots[j_ + 1 + i - steps] - spline_.knots[j_ - degree() + i]);
  }

  /// Replaces points r … degree of the (r − 1)-th derivative by those of the r-th.
  void difference(std::size_t r) {
    for (std::size_t i = degree(); i >= r; --i) {
      const double factor = static_cast<double>(degree() - r + 1) / span(i, r);
      for (std::size_t d = 0; d < dimensions_; ++d) {
        double& point = points_[i * dimensions_ + d];
        point = (point - points_[(i - 1) * dimensions_ + d]) * factor;
      }
    }
  }

  /// The r-th derivative at knot j.
  [[nodiscard]] std::vector<double> value(std::size_t r) const {
    std::vector<double> points = points_;
    for (std::size_t step = r + 1; step <= degree(); ++step) {
      for (std::size_t i = degree(); i >= step; --i) {
        const Time from_low = spline_.knots[j_] - spline_.knots[j_ - degree() + i];
        const double share = to_seconds(from_low) / span(i, step);
        for (std::size_t d = 0; d < dimensions_; ++d) {
          double& point = points[i * dimensions_ + d];
          point = (1 - share) * points[(i - 1) * dimensions_ + d] + share * point;
        }
      }
    }
    return {points.end() - static_cast<std::ptrdiff_t>(dimensions_), points.end()};
  }

  const BSpline& spline_;
  std::size_t j_;
  std::size_t dimensions_;
  std::vector<double> points_;
};

}  // namespace

PiecewisePolynomial from_b_spline(const BSpline& spline) {
  require_knots(spline);
  const auto degree = static_cast<std::size_t>(spline.degree);
  PiecewisePolynomial curve(spline.dimensions);
  for (std::size_t j = degree; j + degree + 1 < spline.knots.size(); ++j) {
    if (spline.knots[j] == spline.knots[j + 1]) continue;
    curve.append(spline.origin + spline.knots[j], spline.origin + spline.knots[j + 1],
                 spline.degree + 1, LocalPolynomial(spline, j).coefficients());
  }
  if (curve.segments() == 0) {
    throw std::invalid_argument("a B-spline of " + std::to_string(spline.knots.size()) +
                                " knots spans no interval of positive length");
  }
  return curve;
}

}  // namespace splinecast
