#pragma once

#include "core/solvers/knot_solver.hpp"

/// The solvers of methods, each in a file of its own; make_knot_solver says what they are given.
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
