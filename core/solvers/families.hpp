#pragma once

#include "core/solvers/knot_solver.hpp"

/// The solvers of methods, each in its own file; make_knot_solver documents the arguments.
namespace splinecast::core {

std::unique_ptr<KnotSolver> make_tridiagonal_solver(const Interpolant& how, const Condition& start,
                                                    std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_local_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_given_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions, Use use);
std::unique_ptr<KnotSolver> make_smoothing_solver(const Interpolant& how, const Condition& start,
                                                  std::size_t dimensions, Use use);

}  // namespace splinecast::core
