#pragma once

namespace splinecast::core {

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

}  // namespace splinecast::core
