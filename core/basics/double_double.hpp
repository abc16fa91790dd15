#pragma once

#include <cmath>

namespace splinecast::core {

/// An unevaluated sum of two doubles: about 106 bits, by Dekker's and Knuth's error-free sums and
/// products. Uses only the basic IEEE operations, so that its bits are the same everywhere.
class DoubleDouble {
 public:
  constexpr DoubleDouble() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): every double is a DoubleDouble
  constexpr DoubleDouble(double value) : high_(value) {}

  [[nodiscard]] constexpr explicit operator double() const noexcept { return high_; }

  friend constexpr DoubleDouble operator+(DoubleDouble a, DoubleDouble b) noexcept {
    const DoubleDouble high = two_sum(a.high_, b.high_);
    const DoubleDouble low = two_sum(a.low_, b.low_);
    const DoubleDouble sum = quick_two_sum(high.high_, high.low_ + low.high_);
    return quick_two_sum(sum.high_, sum.low_ + low.low_);
  }
  friend constexpr DoubleDouble operator-(DoubleDouble a) noexcept { return {-a.high_, -a.low_}; }
  friend constexpr DoubleDouble operator-(DoubleDouble a, DoubleDouble b) noexcept {
    return a + (-b);
  }
  friend constexpr DoubleDouble operator*(DoubleDouble a, DoubleDouble b) noexcept {
    const DoubleDouble product = two_product(a.high_, b.high_);
    return quick_two_sum(product.high_, product.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  friend constexpr DoubleDouble operator/(DoubleDouble a, DoubleDouble b) noexcept {
    const double first = a.high_ / b.high_;
    DoubleDouble rest = a - b * first;
    const double second = rest.high_ / b.high_;
    rest = rest - b * second;
    return quick_two_sum(first, second) + DoubleDouble(rest.high_ / b.high_);
  }
  friend constexpr bool operator==(DoubleDouble a, DoubleDouble b) noexcept {
    return a.high_ == b.high_ && a.low_ == b.low_;
  }
  friend constexpr bool operator>(DoubleDouble a, DoubleDouble b) noexcept {
    return a.high_ > b.high_ || (a.high_ == b.high_ && a.low_ > b.low_);
  }
  constexpr DoubleDouble& operator+=(DoubleDouble other) noexcept { return *this = *this + other; }

 private:
  constexpr DoubleDouble(double high, double low) : high_(high), low_(low) {}

  static constexpr DoubleDouble quick_two_sum(double a, double b) noexcept {
    const double sum = a + b;
    return {sum, b - (sum - a)};
  }
  static constexpr DoubleDouble two_sum(double a, double b) noexcept {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
  }
  static constexpr DoubleDouble split(double a) noexcept {
    const double scaled = 134217729.0 * a;  // 2^27 + 1
    const double high = scaled - (scaled - a);
    return {high, a - high};
  }
  static constexpr DoubleDouble two_product(double a, double b) noexcept {
    const double product = a * b;
    const DoubleDouble x = split(a);
    const DoubleDouble y = split(b);
    return {product, ((x.high_ * y.high_ - product) + x.high_ * y.low_ + x.low_ * y.high_) +
                         x.low_ * y.low_};
  }

  double high_ = 0;
  double low_ = 0;
};

}  // namespace splinecast::core
