#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <algorithm>
#include <vector>

#include "bench/harness/bench_stream.hpp"

/// Eigen: the equations of the window of `append`, solved again for each new waypoint.
namespace splinecast::bench {
namespace {

constexpr int kDimensions = 7;
constexpr int kKnots = 8;  // the settle lag of append/settle:8

using Matrix = Eigen::Matrix<double, kKnots, kKnots>;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Velocities = Eigen::Matrix<double, kKnots, kDimensions>;

/// The newest knots and their equations: row i says that the acceleration is continuous at knot i.
/// The velocity of the knot before the first is known, that of the newest is of the parabola
/// through the last three. Each row is scaled so that the matrix is symmetric.
class Window {
 public:
  Window() {
    for (int i = 0; i < kKnots + 1; ++i) add();
  }

  /// Takes one waypoint more and sets the equations up: the diagonal, what is beside it, and the
  /// right-hand sides.
  void append() {
    times_.head<kKnots>() = times_.tail<kKnots>().eval();
    positions_.topRows<kKnots>() = positions_.bottomRows<kKnots>().eval();
    add();
    const Eigen::Array<double, kKnots, 1> h = times_.tail<kKnots>() - times_.head<kKnots>();
    const Velocities slopes =
        ((positions_.bottomRows<kKnots>() - positions_.topRows<kKnots>()).array().colwise() / h)
            .matrix();
    for (int i = 0; i + 1 < kKnots; ++i) {
      diagonal[i] = 2 / h[i] + 2 / h[i + 1];
      beside[i] = i + 2 < kKnots ? 1 / h[i + 1] : 0;
      right.row(i) = 3 * (slopes.row(i) / h[i] + slopes.row(i + 1) / h[i + 1]);
    }
    constexpr int kLast = kKnots - 1;
    diagonal[kLast] = 1;
    right.row(kLast) = slopes.row(kLast) + h[kLast] / (h[kLast] + h[kLast - 1]) *
                                               (slopes.row(kLast) - slopes.row(kLast - 1));
    right.row(kLast - 1) -= right.row(kLast) / h[kLast];
    right.row(0) -= before_ / h[0];
  }

  Eigen::Array<double, kKnots, 1> diagonal, beside;
  Velocities right;

 private:
  void add() {
    const Waypoint waypoint = feed_.next();
    times_[kKnots] = to_seconds(waypoint.time);
    positions_.row(kKnots) =
        Eigen::Map<const Eigen::RowVectorXd>(waypoint.position.data(), kDimensions);
  }

  Feed feed_{kDimensions};
  Eigen::Array<double, kKnots + 1, 1> times_ = decltype(times_)::LinSpaced(0, kKnots);
  Eigen::Matrix<double, kKnots + 1, kDimensions> positions_ = decltype(positions_)::Zero();
  Eigen::Matrix<double, 1, kDimensions> before_ = decltype(before_)::Zero();
};

/// A dense factorisation of fixed size.
template <typename Factorisation>
class Dense {
 public:
  Velocities solve(const Window& window) {
    Matrix matrix = Matrix::Zero();
    for (int i = 0; i < kKnots; ++i) matrix(i, i) = window.diagonal[i];
    for (int i = 0; i + 1 < kKnots; ++i) matrix(i, i + 1) = matrix(i + 1, i) = window.beside[i];
    return Factorisation(matrix).solve(window.right);
  }
};

/// A sparse factorisation, whose pattern is analysed once.
template <typename Factorisation>
class Sparse {
 public:
  Sparse() {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < kKnots; ++i) {
      for (int j = std::max(i - 1, 0); j < std::min(i + 2, kKnots); ++j)
        entries.emplace_back(j, i, 1);
    }
    matrix_.setFromTriplets(entries.begin(), entries.end());
    factorisation_.analyzePattern(matrix_);
  }

  Velocities solve(const Window& window) {
    double* value = matrix_.valuePtr();  // column by column
    for (int i = 0; i < kKnots; ++i) {
      if (i > 0) *value++ = window.beside[i - 1];
      *value++ = window.diagonal[i];
      if (i + 1 < kKnots) *value++ = window.beside[i];
    }
    factorisation_.factorize(matrix_);
    return factorisation_.solve(window.right);
  }

 private:
  SparseMatrix matrix_{kKnots, kKnots};
  Factorisation factorisation_;
};

template <typename Solver>
void append(benchmark::State& bench) {
  Window window;
  Solver solver;
  Dense<Eigen::PartialPivLU<Matrix>> check;
  window.append();
  if (!solver.solve(window).isApprox(check.solve(window), 1e-12)) {
    bench.SkipWithError("wrong solution");
  }
  for (auto _ : bench) {
    window.append();
    Velocities velocities = solver.solve(window);
    benchmark::DoNotOptimize(velocities.data());
  }
}

BENCHMARK_TEMPLATE(append, Dense<Eigen::PartialPivLU<Matrix>>)
    ->Name("eigen/append/dims:7/settle:8/dense_lu");
BENCHMARK_TEMPLATE(append, Dense<Eigen::LLT<Matrix>>)
    ->Name("eigen/append/dims:7/settle:8/dense_llt");
BENCHMARK_TEMPLATE(append, Sparse<Eigen::SparseLU<SparseMatrix>>)
    ->Name("eigen/append/dims:7/settle:8/sparse_lu");
BENCHMARK_TEMPLATE(append, Sparse<Eigen::SimplicialLDLT<SparseMatrix>>)
    ->Name("eigen/append/dims:7/settle:8/sparse_ldlt");

}  // namespace
}  // namespace splinecast::bench
