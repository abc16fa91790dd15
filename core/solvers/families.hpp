#pragma once

#include "core/solvers/knot_solver.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast {
struct Waypoints;
}  // namespace splinecast

/// The solvers of methods, each in its own file; make_knot_solver documents the arguments.
namespace splinecast::core {

struct SlopeRule;

using MakeSolver = std::unique_ptr<KnotSolver> (*)(const Interpolant& how, const Condition& start,
                                                   std::size_t dimensions, Use use);
using FitAtOnce = PiecewisePolynomial (*)(const Waypoints& waypoints, const Condition& start,
                                          const Condition& end);

/// How the knot velocities of a method are computed.
struct Procedure {
  MakeSolver solver = nullptr;      ///< makes its solver; null: batch only
  FitAtOnce fit_at_once = nullptr;  ///< fits all waypoints at once; null: uses `solver`
  const SlopeRule* rule = nullptr;  ///< slope rule of a local method
};

/// The procedure of an element of methods(), from the same table.
[[nodiscard]] const Procedure& procedure_of(const Method& method) noexcept;

std::unique_ptr<KnotSolver> make_tridiagonal_solver(const Interpolant& how, const Condition& start,
                                                    std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_local_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_given_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_smoothing_solver(const Interpolant& how, const Condition& start,
                                                  std::size_t dimensions, Use use);

}  // namespace splinecast::core
