#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "core/polynomial/segment.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"

namespace splinecast::core {
namespace {

/// power!/(power − derivative)!
constexpr double falling_factorial(std::size_t power, std::size_t derivative) noexcept {
  std::size_t product = 1;
  for (std::size_t k = 0; k < derivative; ++k) product *= power - k;
  return static_cast<double>(product);
}

/// The times at which a polynomial is evaluated, and the output.
struct Times {
  const double* u;
  std::size_t size;
  double* out;
  std::size_t stride;
};

/// The terms of Horner's rule for one derivative and some dimensions.
template <typename Lane, int kOrder, int kDerivative>
class Terms {
 public:
  [[gnu::always_inline]] Terms(const double* coefficients, std::size_t dimensions) noexcept
      : Terms(coefficients, dimensions, Powers{}) {}

  [[nodiscard, gnu::always_inline]] Lane evaluate(double u) const noexcept {
    return evaluate(u, Powers{});
  }

 private:
  static constexpr std::size_t kTerms = kOrder - kDerivative;
  using Powers = std::make_index_sequence<kTerms>;

  // Fold expressions, not loops: compilers unroll loops too late to keep the arrays in registers.
  template <std::size_t... kTerm>
  [[gnu::always_inline]] Terms(const double* coefficients, std::size_t dimensions,
                               std::index_sequence<kTerm...> /*terms*/) noexcept
      : values_{falling_factorial(kTerm + kDerivative, kDerivative) *
                load_lane<Lane>(coefficients + (kTerm + kDerivative) * dimensions)...} {}
  template <std::size_t... kTerm>
  [[nodiscard, gnu::always_inline]] Lane evaluate(
      double u, std::index_sequence<kTerm...> /*terms*/) const noexcept {
    Lane value = values_[kTerms - 1];
    ((value = kTerm == 0 ? value : value * u + values_[kTerms - 1 - kTerm]), ...);
    return value;
  }

  std::array<Lane, kTerms> values_;
};

/// Does the same as for_overlapping_lanes, but uses only one type of lane per call, and calls
/// `body` at one place for each type. This keeps the code small: `body` is long and is inlined.
template <typename Body>
[[gnu::always_inline]] inline void for_widest_lanes(std::size_t dimensions,
                                                    const Body& body) noexcept {
  const auto cover = [&](auto lane) __attribute__((always_inline)) {
    const std::size_t last = dimensions - kWidth<typename decltype(lane)::type>;
    for (std::size_t first = 0;;
         first = std::min(first + kWidth<typename decltype(lane)::type>, last)) {
      body(lane, first);
      if (first == last) break;
    }
  };
  if (dimensions >= 4) return cover(std::type_identity<FourLanes>{});
  if (dimensions >= 2) return cover(std::type_identity<TwoLanes>{});
  body(std::type_identity<double>{}, 0);
}

/// Evaluates all derivatives of some dimensions, one time after the other.
template <typename Lane, int kOrder>
[[gnu::always_inline]] inline void evaluate_all(const double* coefficients, std::size_t dimensions,
                                                const Times& times) noexcept {
  const Terms<Lane, kOrder, 0> position(coefficients, dimensions);
  const Terms<Lane, kOrder, 1> velocity(coefficients, dimensions);
  const Terms<Lane, kOrder, 2> acceleration(coefficients, dimensions);
  const Terms<Lane, kOrder, 3> jerk(coefficients, dimensions);
  double* out = times.out;
  for (std::size_t i = 0; i < times.size; ++i) {
    const double u = times.u[i];
    store_lane(out, position.evaluate(u));
    store_lane(out + dimensions, velocity.evaluate(u));
    store_lane(out + 2 * dimensions, acceleration.evaluate(u));
    store_lane(out + 3 * dimensions, jerk.evaluate(u));
    out += times.stride;
  }
}

/// Evaluates one derivative of some dimensions at all times, if it is in the set. Returns where to
/// write the next one.
template <typename Lane, int kOrder, int kDerivative>
[[gnu::always_inline]] inline double* evaluate_one(const double* coefficients,
                                                   std::size_t dimensions, Derivatives which,
                                                   const Times& times, double* first) noexcept {
  if (!contains(which, static_cast<Derivatives>(1 << kDerivative))) return first;
  const Terms<Lane, kOrder, kDerivative> terms(coefficients, dimensions);
  double* out = first;
  for (std::size_t i = 0; i < times.size; ++i) {
    store_lane(out, terms.evaluate(times.u[i]));
    out += times.stride;
  }
  return first + dimensions;
}

template <int kOrder>
[[gnu::always_inline]] inline void evaluate_order(const double* coefficients,
                                                  std::size_t dimensions, Derivatives which,
                                                  const Times& times) noexcept {
  const auto body = [&](auto lane, std::size_t first) __attribute__((always_inline)) {
    using Lane = typename decltype(lane)::type;
    const double* const c = coefficients + first;
    double* out = times.out + first;
    if (which == Derivatives::all) {
      evaluate_all<Lane, kOrder>(c, dimensions, {times.u, times.size, out, times.stride});
      return;
    }
    out = evaluate_one<Lane, kOrder, 0>(c, dimensions, which, times, out);
    out = evaluate_one<Lane, kOrder, 1>(c, dimensions, which, times, out);
    out = evaluate_one<Lane, kOrder, 2>(c, dimensions, which, times, out);
    (void)evaluate_one<Lane, kOrder, 3>(c, dimensions, which, times, out);
  };
  for_widest_lanes(dimensions, body);
}

/// The same for all other orders, which are rarely used.
void evaluate_any_order(int order, std::span<const double> coefficients, std::size_t dimensions,
                        Derivatives which, const Times& times) noexcept {
  for (std::size_t i = 0; i < times.size; ++i) {
    double* out = times.out + i * times.stride;
    for (int derivative = 0; derivative < 4; ++derivative) {
      if (!contains(which, static_cast<Derivatives>(1 << derivative))) continue;
      evaluate_derivative(order, coefficients, times.u[i], derivative, {out, dimensions});
      out += dimensions;
    }
  }
}

}  // namespace

SPLINECAST_VECTOR_CLONES
void evaluate_many(int order, std::span<const double> coefficients, std::size_t dimensions,
                   std::span<const double> u, Derivatives which, std::span<double> out,
                   std::size_t stride) noexcept {
  // Few enough that the output stays in the cache while it is written lane by lane, and enough that
  // compilers do not unroll the loop.
  constexpr std::size_t kTimesAtOnce = 24;
  const double* const c = coefficients.data();
  for (std::size_t i = 0; i < u.size(); i += kTimesAtOnce) {
    const Times times{u.data() + i, std::min(kTimesAtOnce, u.size() - i), out.data() + i * stride,
                      stride};
    if (order == kCubicOrder) {
      evaluate_order<kCubicOrder>(c, dimensions, which, times);
    } else if (order == kMaxOrder) {
      evaluate_order<kMaxOrder>(c, dimensions, which, times);
    } else {
      evaluate_any_order(order, coefficients, dimensions, which, times);
    }
  }
}

}  // namespace splinecast::core
