#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::core {
struct SlopeRule;
}  // namespace splinecast::core

namespace [[gnu::visibility("default")]] splinecast {

/// What a method promises of its curves; the tests hold every method to it.
struct Laws {
  int continuity;            ///< C^0, C^1 or C^2 at the knots
  int degree;                ///< highest degree of the polynomials in time that it reproduces on
                             ///< any mesh, given the right ends
  int order_of_convergence;  ///< error in position O(h^this) away from the ends, on regular
                             ///< meshes, for a smooth function without extrema
  bool is_interpolating = true;  ///< passes through its waypoints
  bool is_linear = true;  ///< equivariant to every affine map of x, also between dimensions; else
                          ///< to those of each dimension alone
  bool is_scale_free = true;  ///< equivariant to scaling of x; else to shifts and mirroring only
};

/// Where a method's knot velocities come from.
enum class Family : std::uint8_t {
  tridiagonal,  ///< a tridiagonal system over all knots: `c2`
  local,        ///< a slope rule
  given,        ///< the waypoints themselves: `hermite`, `quintic`
  smoothing,    ///< a pentadiagonal system over all knots, which moves the knots too
  unit,         ///< the tridiagonal system on unit intervals: `normalized`
};

/// An interpolant. There is one object for each; compare by address.
struct Method {
  std::string_view name;
  std::uint64_t number = 0;  ///< names it in shared memory: never given to another
  Family family{};
  const core::SlopeRule* rule = nullptr;  ///< of a local method
  int order = kCubicOrder;                ///< of its segments; 6 also takes accelerations
  std::size_t look_ahead = 0;             ///< knots after which a knot is exact; 0: never quite
  Laws laws{};

  /// Whether it can be solved while waypoints come.
  [[nodiscard]] bool streams() const noexcept { return family != Family::unit; }
  /// Whether a longer settle lag makes it more accurate.
  [[nodiscard]] bool converges() const noexcept {
    return family == Family::tridiagonal || family == Family::smoothing;
  }
  [[nodiscard]] bool needs_velocity() const noexcept { return family == Family::given; }
  [[nodiscard]] bool needs_acceleration() const noexcept {
    return family == Family::given && order == kMaxOrder;
  }
  /// Whether it has a tail of its own at the newest knot, which no option changes.
  [[nodiscard]] bool has_own_tail() const noexcept {
    return family == Family::given || family == Family::smoothing;
  }
};

/// All methods, `c2` first.
[[nodiscard]] std::span<const Method> methods() noexcept;

/// The default: the C² cubic spline.
[[nodiscard]] const Method& c2() noexcept;

/// The method of that name or number; nullptr if there is none.
[[nodiscard]] const Method* find_method(std::string_view name) noexcept;
[[nodiscard]] const Method* find_method(std::uint64_t number) noexcept;

/// The names of all methods, or of those that stream, with ", " between.
[[nodiscard]] std::string method_names(bool only_streaming);

/// A method and its parameters: all that makes a curve of waypoints but the conditions at its ends.
struct Interpolant {
  const Method* method = &c2();
  double lambda = 0;  ///< of `smoothing`: λ, 0 … 1e100, in s³, in Σ(x_i − f(t_i))² + λ∫f″²
  double time_scale = 1;  ///< of `rounded`: > 0, seconds that count as one unit of position

  friend bool operator==(const Interpolant&, const Interpolant&) = default;
};

/// Throws std::invalid_argument, naming the value, for a parameter out of range.
void require_parameters(const Interpolant& interpolant);

}  // namespace gnu::visibility("default")]]splinecast
