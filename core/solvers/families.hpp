#pragma once

#include "core/solvers/knot_solver.hpp"

/// One solver a family, each in a file of its own.
namespace splinecast::core {

std::unique_ptr<KnotSolver> make_tridiagonal_solver(const Condition& start, std::size_t dimensions);
std::unique_ptr<KnotSolver> make_local_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions);
std::unique_ptr<KnotSolver> make_given_solver(const Interpolant& how, const Condition& start,
                                              std::size_t dimensions);
std::unique_ptr<KnotSolver> make_smoothing_solver(const Interpolant& how, const Condition& start,
                                                  std::size_t dimensions, Use use);

}  // namespace splinecast::core
