// Fits a curve to waypoints, without shared memory, and prints its largest speeds, its mean
// position, and how its acceleration changes.
//
//   12_fit
//
// Needs no other process.

#include <array>
#include <chrono>
#include <cstdio>
#include <exception>

#include <splinecast/calculus.hpp>
#include <splinecast/fit.hpp>
#include <splinecast/time.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

void print_curve() {
  const std::array<Time, 5> times{0ms, 200ms, 500ms, 700ms, 1000ms};
  const std::array positions{0.0, 0.1, 0.4, 0.5, 0.5};  // one dimension [m]
  const PiecewisePolynomial curve =
      fit({.dimensions = 1, .times = times, .positions = positions}, {});
  const Extremes speeds = extremes(curve, 0, 1);
  std::printf("velocity %.3f to %.3f m/s\n", speeds.least.value, speeds.greatest.value);

  // The integral is 0 at the first break: its value at the last one is the area below the curve.
  const PiecewisePolynomial area = integrated(curve);
  std::array<double, 1> total{};
  area.derivative(times.back(), 0, total);
  std::printf("mean position %.3f m\n", total[0] / to_seconds(times.back() - times.front()));

  const PiecewisePolynomial acceleration = differentiated(differentiated(curve));
  for (const Time t : times) {
    std::array<double, 1> value{};
    acceleration.derivative(t, 0, value);
    std::printf("%4.1f s: %6.2f m/s^2\n", to_seconds(t), value[0]);
  }
}

}  // namespace

int main() {
  try {
    print_curve();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
