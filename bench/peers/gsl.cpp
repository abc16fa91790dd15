#include <benchmark/benchmark.h>
#include <gsl/gsl_spline.h>

#include <array>
#include <memory>

#include "bench/harness/bench_stream.hpp"
#include "bench/harness/random_times.hpp"

/// The GNU Scientific Library: a cubic spline and an accelerator per dimension, in this process.
namespace splinecast::bench {
namespace {

/// Splines through the same knots, one per dimension.
class Splines {
 public:
  explicit Splines(const Waypoints& waypoints) : count_(waypoints.times.size()) {
    for (const Time t : waypoints.times) x_.push_back(to_seconds(t));
    for (std::size_t d = 0; d < waypoints.dimensions; ++d) {
      std::vector<double> y;
      for (std::size_t i = 0; i < count_; ++i) y.push_back(waypoints.position(i)[d]);
      y_.push_back(std::move(y));
      splines_.emplace_back(gsl_spline_alloc(gsl_interp_cspline, count_), gsl_spline_free);
      accelerators_.emplace_back(gsl_interp_accel_alloc(), gsl_interp_accel_free);
    }
    solve();
  }

  void solve() {
    for (std::size_t d = 0; d < splines_.size(); ++d) {
      gsl_spline_init(splines_[d].get(), x_.data(), y_[d].data(), count_);
    }
  }

  /// Position, velocity and acceleration of each dimension; GSL has no jerk.
  void sample(double t, double* out) const {
    for (std::size_t d = 0; d < splines_.size(); ++d) {
      gsl_spline* const spline = splines_[d].get();
      gsl_interp_accel* const accelerator = accelerators_[d].get();
      *out++ = gsl_spline_eval(spline, t, accelerator);
      *out++ = gsl_spline_eval_deriv(spline, t, accelerator);
      *out++ = gsl_spline_eval_deriv2(spline, t, accelerator);
    }
  }

 private:
  std::size_t count_;
  std::vector<double> x_;
  std::vector<std::vector<double>> y_;
  std::vector<std::unique_ptr<gsl_spline, void (*)(gsl_spline*)>> splines_;
  std::vector<std::unique_ptr<gsl_interp_accel, void (*)(gsl_interp_accel*)>> accelerators_;
};

/// The same as `sample`, through the same waypoints.
void sample(benchmark::State& bench) {
  const Waypoints waypoints(4096, static_cast<std::size_t>(bench.range(0)));
  const Splines splines(waypoints);
  std::vector<double> out(3 * waypoints.dimensions);
  Time t{};
  for (auto _ : bench) {
    splines.sample(to_seconds(t), out.data());
    benchmark::DoNotOptimize(out.data());
    t += Time(1'000'000);
    if (t > waypoints.times.back()) t = Time{};
  }
}

/// The same as `sample_random`, at the same times.
void sample_random(benchmark::State& bench) {
  static const Waypoints waypoints(kRandomSegments, 7);
  static const Splines splines(waypoints);
  std::vector<double> out(3 * waypoints.dimensions);
  const std::vector<Time> times = random_times(waypoints.times.back());
  std::size_t i = 0;
  for (auto _ : bench) {
    splines.sample(to_seconds(times[i++ % times.size()]), out.data());
    benchmark::DoNotOptimize(out.data());
  }
}

/// A new waypoint with GSL: solves all knots again, here the last 1,024.
void append(benchmark::State& bench) {
  const Waypoints waypoints(1024, static_cast<std::size_t>(bench.range(0)));
  Splines splines(waypoints);
  for (auto _ : bench) {
    splines.solve();
    benchmark::ClobberMemory();
  }
}

BENCHMARK(sample)->Name("gsl/sample")->ArgName("dims")->Apply(all_dimensions);
BENCHMARK(sample_random)->Name("gsl/sample_random/dims:7");
BENCHMARK(append)->Name("gsl/append")->ArgName("dims")->Apply(all_dimensions);

}  // namespace
}  // namespace splinecast::bench
