#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Properties of the curves of a method; the tests check them for every method.
struct Laws {
  int continuity;            ///< C^0, C^1 or C^2 at the knots
  int degree;                ///< highest degree of polynomials in time that it reproduces on any
                             ///< mesh, with matching boundary conditions
  int order_of_convergence;  ///< error in position O(h^this) away from the ends, on regular
                             ///< meshes, for a smooth function without extrema
  bool is_interpolating = true;  ///< passes through its waypoints
  bool is_linear = true;  ///< equivariant to every affine map of x, also between dimensions; else
                          ///< to those of each dimension separately
  bool is_scale_free = true;  ///< equivariant to scaling of x; else to shifts and mirroring only
};

/// Properties that follow from how a method computes its knot velocities. The defaults are those of
/// a method that computes them from the positions around a knot.
struct MethodTraits {
  bool streams = false;                        ///< it can be solved while waypoints arrive
  bool converges = false;                      ///< a longer settle lag makes it more accurate
  bool needs_velocity = false;                 ///< in the waypoints; with order 6 accelerations too
  bool has_own_tail = false;                   ///< its condition at the newest knot is fixed
  bool smooths = false;                        ///< it uses λ, and moves the knots
  ConditionKind own_end = ConditionKind::own;  ///< default at the end of a stream
};

/// A method of interpolation. There is one object for each; compare by address.
struct Method {
  std::string_view name;
  std::uint64_t number = 0;  ///< identifies it in shared memory; never reused
  MethodTraits traits{};
  int order = kCubicOrder;     ///< of its segments; with 6 it may also need accelerations
  std::size_t look_ahead = 0;  ///< newer knots after which a knot is exact; 0: never
  Laws laws{};

  /// Whether it can be solved online, while waypoints arrive.
  [[nodiscard]] bool streams() const noexcept { return traits.streams; }
  /// Whether a longer settle lag makes it more accurate.
  [[nodiscard]] bool converges() const noexcept { return traits.converges; }
  [[nodiscard]] bool needs_velocity() const noexcept { return traits.needs_velocity; }
  [[nodiscard]] bool needs_acceleration() const noexcept {
    return traits.needs_velocity && order == kMaxOrder;
  }
  /// Whether its condition at the newest knot is fixed, so that no option changes it.
  [[nodiscard]] bool has_own_tail() const noexcept { return traits.has_own_tail; }
  /// Whether it uses λ and passes near its waypoints, not through them.
  [[nodiscard]] bool smooths() const noexcept { return traits.smooths; }
};

/// All methods, `c2` first.
[[nodiscard]] std::span<const Method> methods() noexcept;

/// The default: the C² cubic spline.
[[nodiscard]] const Method& c2() noexcept;

/// The method of that name or number; nullptr if there is none.
[[nodiscard]] const Method* find_method(std::string_view name) noexcept;
[[nodiscard]] const Method* find_method(std::uint64_t number) noexcept;

/// The names of all methods, or of those that stream, separated by ", ".
[[nodiscard]] std::string method_names(bool only_streaming);

/// A method and its parameters: all options of a curve except the boundary conditions.
struct Interpolant {
  const Method* method = &c2();
  double lambda = 0;  ///< for `smoothing`: λ in Σ(x_i − f(t_i))² + λ∫f″², 0 … 1e100 s³
  double time_scale = 1;  ///< for `rounded`: > 0, seconds that count as one unit of position

  friend bool operator==(const Interpolant&, const Interpolant&) = default;
};

/// Throws std::invalid_argument, naming the value, for a parameter out of range.
void require_parameters(const Interpolant& interpolant);

}  // namespace splinecast
