#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/polynomial/roots.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/calculus.hpp"

namespace splinecast {
namespace {

/// Positive nodes and weights of ten-point Gauss–Legendre on [−1, 1]: exact up to degree 19.
constexpr std::array<double, 5> kNodes{0.14887433898163122, 0.4333953941292472, 0.6794095682990244,
                                       0.8650633666889845, 0.9739065285171717};
constexpr std::array<double, 5> kWeights{0.2955242247147529, 0.2692667193099964, 0.219086362515982,
                                         0.14945134915058059, 0.06667134430868814};

/// Maximum depth of halving. Only pieces near a complex zero of |v|² need more halvings, and there
/// are at most 2k such zeros, so that the work is linear in this depth, not exponential.
constexpr int kMostHalvings = 24;

/// Largest difference between an integral and the sum of its halves, relative to the length of the
/// whole segment.
constexpr double kAgreement = 1e-13;

/// The path of one segment in s = u/h, 0 ≤ s ≤ 1.
class UnitPath {
 public:
  UnitPath(const PiecewisePolynomial& curve, std::size_t segment)
      : order_(curve.order_of(segment)),
        coefficients_(curve.coefficients(segment).begin(), curve.coefficients(segment).end()),
        velocity_(curve.dimensions()) {
    const double h = curve.seconds(segment);
    double scale = 1;
    for (std::size_t k = 0; k < coefficients_.size(); ++k) {
      if (k > 0 && k % velocity_.size() == 0) scale *= h;
      coefficients_[k] *= scale;
    }
  }

  /// The length, as a sum over the pieces between the minima and maxima of the speed.
  double length() {
    core::Roots ends = core::unit_roots(slope_of_squared_speed(), 0);
    if (ends.count == 0 || ends.values[ends.count - 1] < 1) ends.values[ends.count++] = 1;
    std::array<double, core::kMaxRootCoefficients + 1> rough{};
    double from = 0;
    for (std::size_t i = 0; i < ends.count; ++i) {
      rough[i] = gauss(std::exchange(from, ends.values[i]), ends.values[i]);
    }
    const double agreement = kAgreement * std::accumulate(rough.begin(), rough.end(), 0.0);
    double sum = 0;
    from = 0;
    for (std::size_t i = 0; i < ends.count; ++i) {
      sum += halved(std::exchange(from, ends.values[i]), ends.values[i], rough[i], agreement,
                    kMostHalvings);
    }
    return sum;
  }

 private:
  double speed(double s) {
    core::evaluate_derivative(order_, coefficients_, s, 1, velocity_);
    double sum = 0;
    for (const double v : velocity_) sum += v * v;
    return std::sqrt(sum);
  }

  double gauss(double from, double to) {
    const double middle = (from + to) / 2;
    const double half = (to - from) / 2;
    double sum = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      sum += kWeights[i] * (speed(middle - half * kNodes[i]) + speed(middle + half * kNodes[i]));
    }
    return sum * half;
  }

  double halved(double from, double to, double whole, double agreement, int halvings) {
    const double middle = (from + to) / 2;
    const double left = gauss(from, middle);
    const double right = gauss(middle, to);
    if (halvings == 0 || !(std::abs(left + right - whole) > agreement)) return left + right;
    return halved(from, middle, left, agreement, halvings - 1) +
           halved(middle, to, right, agreement, halvings - 1);
  }

  /// Coefficients of d|v|²/ds = 2 v·a.
  [[nodiscard]] std::vector<double> slope_of_squared_speed() const;

  int order_;
  std::vector<double> coefficients_;
  std::vector<double> velocity_;
};

std::vector<double> UnitPath::slope_of_squared_speed() const {
  const std::size_t dimensions = velocity_.size();
  const auto order = static_cast<std::size_t>(order_);
  std::vector<double> slope(order > 2 ? 2 * order - 4 : 0);
  for (std::size_t k = 1; k < order; ++k) {
    for (std::size_t j = 2; j < order; ++j) {
      const auto factor = static_cast<double>(2 * k * j * (j - 1));
      for (std::size_t d = 0; d < dimensions; ++d) {
        slope[k + j - 3] +=
            factor * coefficients_[k * dimensions + d] * coefficients_[j * dimensions + d];
      }
    }
  }
  return slope;
}

}  // namespace

double arc_length(const PiecewisePolynomial& curve, Time from, Time to) {
  const PiecewisePolynomial part = restricted(curve, from, to);
  double length = 0;
  for (std::size_t i = 0; i < part.segments(); ++i) length += UnitPath(part, i).length();
  return length;
}

}  // namespace splinecast
