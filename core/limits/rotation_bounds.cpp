#include "core/limits/rotation_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace splinecast::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Accepted ratio of a bound to the largest value found so far.
constexpr double kSlack = 1 + 1e-6;
constexpr std::size_t kMaxPieces = 64;
constexpr int kMaxSplits = 300;

/// Turns Σ c_k s^k into the coefficients of the powers of (s − from)/width.
void shift(std::span<double> c, double from, double width) noexcept {
  for (std::size_t i = 0; i + 1 < c.size(); ++i) {
    for (std::size_t j = c.size() - 1; j-- > i;) c[j] += from * c[j + 1];
  }
  double power = 1;
  for (double& term : c) {
    term *= power;
    power *= width;
  }
}

/// Turns coefficients into the Bernstein control points on [from, from + width].
void to_control_points(std::span<double> c, double from, double width) noexcept {
  shift(c, from, width);
  double binomial = 1;
  for (std::size_t k = 1; k < c.size(); ++k) {
    binomial = binomial * static_cast<double>(c.size() - k) / static_cast<double>(k);
    c[k] /= binomial;
  }
  for (std::size_t round = 1; round < c.size(); ++round) {
    for (std::size_t j = c.size() - 1; j >= round; --j) c[j] += c[j - 1];
  }
}

template <std::size_t N>
std::array<double, N> derivative_of(const std::array<double, N>& c) noexcept {
  std::array<double, N> out{};
  for (std::size_t k = 1; k < N; ++k) out[k - 1] = static_cast<double>(k) * c[k];
  return out;
}

/// Adds factor·a·b.
void add_product(std::span<double> to, double factor, std::span<const double> a,
                 std::span<const double> b) noexcept {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size() && i + j < to.size(); ++j) {
      to[i + j] += factor * a[i] * b[j];
    }
  }
}

/// Bounds the largest value of a quotient on [0, width] from above. Does not refine a bound that is
/// at most `accepted`; stops at a value above `rejected`.
class PeakSearch {
 public:
  PeakSearch(const RotationQuotient& rotation, double accepted, double rejected) noexcept
      : rotation_(rotation), accepted_(accepted), rejected_(rejected) {}

  [[nodiscard]] Extreme run(double width) noexcept {
    add(0, width);
    for (int i = 0;; ++i) {
      settle();
      const auto open = std::span(pieces_).first(count_);
      if (open.empty()) return {settled_, at_};
      Piece& top = *std::ranges::max_element(open, {}, &Piece::bound);
      const bool is_last = count_ == kMaxPieces || i == kMaxSplits || top.width == 0;
      if (reached_ > rejected_ || is_last) return {top.bound, at_};
      const Piece split = std::exchange(top, open.back());
      --count_;
      add(split.from, split.width / 2);
      add(split.from + split.width / 2, split.width / 2);
    }
  }

 private:
  struct Piece {
    double from;
    double width;
    double bound;
  };

  void add(double from, double width) noexcept {
    const double middle = from + width / 2;
    const double here = value_at(middle);
    if (here > reached_ && here < kInfinity) {
      reached_ = here;
      at_ = middle;
    }
    pieces_[count_++] = {from, width, bound_in(from, width)};
  }

  /// Removes the pieces that need not be split.
  void settle() noexcept {
    std::size_t left = 0;
    for (const Piece& piece : std::span(pieces_).first(count_)) {
      if (piece.bound <= std::max(accepted_, reached_ * kSlack)) {
        settled_ = std::max(settled_, piece.bound);
      } else {
        pieces_[left++] = piece;
      }
    }
    count_ = left;
  }

  [[nodiscard]] double bound_in(double from, double width) const noexcept {
    RotationQuotient points = rotation_;
    const auto turn = [&](RotationQuotient::Terms& terms) {
      to_control_points(std::span(terms).first(points.terms), from, width);
    };
    turn(points.denominator);
    std::ranges::for_each(points.numerator, turn);
    const auto& [x, y, z] = points.numerator;
    double most = 0;
    for (std::size_t k = 0; k < points.terms; ++k) {
      const double size = std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]);
      const double ratio = size / points.denominator[k];
      // Written so that NaN counts as infinite.
      const bool is_bounded = points.denominator[k] > 0 && ratio < kInfinity;
      most = std::max(most, is_bounded ? ratio : kInfinity);
    }
    return most;
  }

  [[nodiscard]] double value_at(double s) const noexcept {
    const auto value = [&](const RotationQuotient::Terms& terms) {
      double sum = 0;
      for (std::size_t k = rotation_.terms; k-- > 0;) sum = sum * s + terms[k];
      return sum;
    };
    const auto& [x, y, z] = rotation_.numerator;
    return std::hypot(value(x), value(y), value(z)) / value(rotation_.denominator);
  }

  const RotationQuotient& rotation_;
  double accepted_;
  double rejected_;
  std::array<Piece, kMaxPieces> pieces_{};
  std::size_t count_ = 0;
  double reached_ = 0;
  double at_ = 0;
  double settled_ = 0;  ///< the largest bound of removed pieces
};

}  // namespace

RotationBounds::RotationBounds(const SegmentPart& part,
                               const QuaternionDimensions& quaternion) noexcept
    : from_(part.from),
      seconds_(part.to > part.from ? part.to - part.from : 1),
      width_(part.to > part.from ? 1 : 0) {
  const auto order = static_cast<std::size_t>(part.order);
  std::array<std::array<double, kMaxOrder>, kQuaternionSize> q{};  // w x y z
  std::array<std::array<double, kMaxOrder>, kQuaternionSize> rate{};
  velocity_.terms = 2 * (order - 1) + 1;
  for (std::size_t i = 0; i < kQuaternionSize; ++i) {
    const std::size_t at = quaternion.w_first ? i : (i + kQuaternionSize - 1) % kQuaternionSize;
    for (std::size_t k = 0; k < order; ++k) {
      q[i][k] = part.coefficients[k * part.dimensions + quaternion.first + at];
    }
    shift(q[i], part.from, seconds_);
    rate[i] = derivative_of(q[i]);
    add_product(velocity_.denominator, 1, q[i], q[i]);
  }
  for (std::size_t i = 1; i < kQuaternionSize; ++i) {
    const std::size_t j = i % 3 + 1;
    const std::size_t k = j % 3 + 1;
    auto& component = velocity_.numerator[i - 1];
    add_product(component, 2, q[0], rate[i]);
    add_product(component, -2, q[i], rate[0]);
    add_product(component, -2, q[j], rate[k]);
    add_product(component, 2, q[k], rate[j]);
  }
}

RotationQuotient RotationBounds::quotient(int r) const noexcept {
  RotationQuotient quotient = velocity_;
  const std::span<const double> n = std::span(velocity_.denominator).first(velocity_.terms);
  const auto slope = derivative_of(velocity_.denominator);
  const auto n_slope = std::span(slope).first(velocity_.terms);
  for (int power = 1; power < r; ++power) {
    RotationQuotient next;
    next.terms = quotient.terms + velocity_.terms - 1;
    for (std::size_t i = 0; i < quotient.numerator.size(); ++i) {
      const auto component_slope = derivative_of(quotient.numerator[i]);
      const auto first = [&](const auto& terms) { return std::span(terms).first(quotient.terms); };
      add_product(next.numerator[i], 1, first(component_slope), n);
      add_product(next.numerator[i], -power, first(quotient.numerator[i]), n_slope);
    }
    add_product(next.denominator, 1, std::span(quotient.denominator).first(quotient.terms), n);
    quotient = next;
  }
  return quotient;
}

Extreme RotationBounds::search(int r, double accepted, double rejected) const noexcept {
  const double unit = std::pow(seconds_, r);
  const RotationQuotient rotation = quotient(r);
  const Extreme found = PeakSearch(rotation, accepted * unit, rejected * unit).run(width_);
  return {found.value / unit, from_ + found.u * seconds_};
}

Extreme RotationBounds::bound(int r) const noexcept { return search(r, 0, kInfinity); }

bool RotationBounds::keeps(int r, double limit) const noexcept {
  return search(r, limit, limit).value <= limit * (1 + kExtremeRounding);
}

}  // namespace splinecast::core
