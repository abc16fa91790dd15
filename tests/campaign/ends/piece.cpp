#include "tests/campaign/ends/piece.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::campaign::ends {
namespace {

/// Error of an extreme, relative to its terms.
constexpr double kRounding = 1e-12;

using Bernstein = std::array<double, kMaxOrder>;

constexpr std::array<std::array<double, kMaxOrder>, kMaxOrder> kBinomial{
    {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}, {1, 5, 10, 10, 5, 1}}};

/// k·(k − 1)·…, m factors.
double falling(std::size_t k, int m) noexcept {
  double product = 1;
  for (int i = 0; i < m; ++i) product *= static_cast<double>(k) - i;
  return product;
}

/// Divides the interval in half until the coefficients inside it show no more than its ends.
void refine(Bernstein b, std::size_t n, double tolerance, int depth, Range& out) noexcept {
  out.least = std::min({out.least, b[0], b[n]});
  out.greatest = std::max({out.greatest, b[0], b[n]});
  double low = b[0];
  double high = b[0];
  for (std::size_t i = 1; i < n; ++i) {
    low = std::min(low, b[i]);
    high = std::max(high, b[i]);
  }
  if (depth == 0 || (low >= out.least - tolerance && high <= out.greatest + tolerance)) return;
  Bernstein right{};
  right[n] = b[n];
  for (std::size_t level = 1; level <= n; ++level) {
    for (std::size_t i = n; i >= level; --i) b[i] = (b[i - 1] + b[i]) / 2;
    right[n - level] = b[n];
  }
  // b now holds the left half; its last coefficient is the first of the right half.
  Bernstein left = b;
  refine(left, n, tolerance, depth - 1, out);
  refine(right, n, tolerance, depth - 1, out);
}

}  // namespace

bool PieceRanges::is_rotation(std::size_t d) const noexcept {
  return std::ranges::any_of(kinds_->quaternions(), [d](const QuaternionDimensions& q) {
    return d - q.first < kQuaternionSize;
  });
}

double PieceRanges::value(const Piece& piece, std::size_t d, int derivative,
                          double u) const noexcept {
  double sum = 0;
  for (int k = piece.order; k-- > derivative;) {
    const auto i = static_cast<std::size_t>(k);
    sum = sum * u + falling(i, derivative) * piece.coefficients[i * dimensions_ + d];
  }
  return sum;
}

Range PieceRanges::range(const Piece& piece, std::size_t d, int derivative,
                         double from) const noexcept {
  const double length = std::max(piece.seconds() - from, 0.0);
  Bernstein b{};
  if (piece.order <= derivative) return {};
  const auto n = static_cast<std::size_t>(piece.order - 1 - derivative);
  Bernstein powers{};  // of the derivative in (u − from)/length
  double power = 1;
  double factorial = 1;
  for (std::size_t j = 0; j <= n; ++j) {
    if (j > 0) factorial *= static_cast<double>(j);
    const double all =
        from == 0
            ? falling(j + static_cast<std::size_t>(derivative), derivative) *
                  piece.coefficients[(j + static_cast<std::size_t>(derivative)) * dimensions_ + d]
            : value(piece, d, derivative + static_cast<int>(j), from) / factorial;
    powers[j] = all * power;
    power *= length;
  }
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) b[i] += kBinomial[i][j] / kBinomial[n][j] * powers[j];
  }
  constexpr int kDepth = 20;
  constexpr double kExact = 1e-7;
  double size = 0;
  for (std::size_t i = 0; i <= n; ++i) size = std::max(size, std::abs(b[i]));
  Range out{.least = b[0], .greatest = b[0]};
  if (!std::isfinite(size)) return {.least = -HUGE_VAL, .greatest = HUGE_VAL};
  refine(b, n, kExact * size, kDepth, out);
  return out;
}

double PieceRanges::scale(const Piece& piece, std::size_t d, int derivative) const noexcept {
  double sum = 0;
  double power = 1;
  for (auto k = static_cast<std::size_t>(derivative); k < static_cast<std::size_t>(piece.order);
       ++k, power *= piece.seconds()) {
    sum += falling(k, derivative) * std::abs(piece.coefficients[k * dimensions_ + d]) * power;
  }
  return sum;
}

double PieceRanges::turn(const Piece& piece, const QuaternionDimensions& q,
                         int derivative) const noexcept {
  constexpr int kLooks = 16;
  double most = 0;
  for (int i = 0; i <= kLooks; ++i) {
    const double u = piece.seconds() * i / kLooks;
    std::array<std::array<double, kQuaternionSize>, 3> x{};
    for (std::size_t k = 0; k < kQuaternionSize; ++k) {
      for (std::size_t m = 0; m < x.size(); ++m) {
        x[m][k] = value(piece, q.first + k, static_cast<int>(m), u);
      }
    }
    // With N = |q|² and W = vec(q*⊗q̇): ω = 2W/N, α = 2(ẆN − WṄ)/N². The vector part of q*⊗p has
    // the same length in both orders of the components up to a sign.
    const std::size_t w = q.w_first ? 0 : 3;
    const std::size_t v = q.w_first ? 1 : 0;
    const auto part = [&](const auto& a, const auto& b, std::size_t c) {
      const std::size_t i1 = v + (c + 1) % 3;
      const std::size_t i2 = v + (c + 2) % 3;
      return a[w] * b[v + c] - a[v + c] * b[w] - (a[i1] * b[i2] - a[i2] * b[i1]);
    };
    double n = 0;
    double dn = 0;
    for (std::size_t k = 0; k < kQuaternionSize; ++k) {
      n += x[0][k] * x[0][k];
      dn += 2 * x[0][k] * x[1][k];
    }
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double first = part(x[0], x[1], c);
      const double second = part(x[0], x[2], c);
      const double size = derivative == 1 ? 2 * first / n : 2 * (second * n - first * dn) / (n * n);
      sum += size * size;
    }
    most = std::max(most, std::sqrt(sum));
  }
  return most;
}

Peaks peaks_of(const PieceRanges& ranges, const Piece& piece, const MotionLimits& limits,
               double from) noexcept {
  Peaks peaks;
  const std::array<const std::vector<double>*, 3> all{&limits.velocity, &limits.acceleration,
                                                      &limits.jerk};
  for (std::size_t d = 0; d < ranges.dimensions(); ++d) {
    if (ranges.is_rotation(d)) continue;
    peaks.position[d] = ranges.range(piece, d, 0, from);
    for (std::size_t m = 0; m < all.size(); ++m) {
      if (all[m]->empty() || (*all[m])[d] <= 0) continue;
      const int derivative = static_cast<int>(m) + 1;
      const double rounding = kRounding * ranges.scale(piece, d, derivative);
      const double size = ranges.range(piece, d, derivative, from).size();
      peaks.ratio[d][m] = std::max(size - rounding, 0.0) / (*all[m])[d];
    }
  }
  for (const QuaternionDimensions& q : ranges.kinds().quaternions()) {
    for (std::size_t m = 0; m < 2; ++m) {
      if (all[m]->empty() || (*all[m])[q.first] <= 0) continue;
      peaks.ratio[q.first][m] = ranges.turn(piece, q, static_cast<int>(m) + 1) / (*all[m])[q.first];
    }
  }
  return peaks;
}

}  // namespace splinecast::campaign::ends
