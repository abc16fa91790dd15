// A predictive controller with Eigen: 500 times a second, the first input that minimises a
// quadratic cost of tracking errors and inputs over a horizon of 50 states, all of one revision. It
// drives a simulated machine, x'' = u in two dimensions, which begins 5 cm beside the curve.
//
//   7_mpc_horizon [STREAM]     default: arm
//
// Needs a stream in motion, with x and y as its first dimensions: 3_embedded_solver, or 1_producer
// and a solver. It ends with the motion, or after 10 s.

#define EIGEN_RUNTIME_NO_MALLOC  // makes Eigen check that it does not allocate: see follow()

#include <Eigen/Core>
#include <Eigen/LU>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <thread>

#include <splinecast/clock.hpp>
#include <splinecast/eigen.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/reader.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr int kHorizon = 50;
constexpr Time kStep = 2ms;  // the horizon, 100 ms, is shorter than the lead of the producer
constexpr int kTicks = 5000;

using Horizon = EigenHorizon<Eigen::Dynamic, Derivatives::position | Derivatives::velocity>;
using Errors = Eigen::Matrix<double, 2, kHorizon>;  // column i: the error in x and y, in i steps
using Gain = Eigen::Matrix<double, kHorizon, 1>;

/// The first input of the plan that minimises Σ |position error|² + |w·velocity error|² + |r·u|²
/// over the horizon. The machine is linear and has no limits, so this input is linear in the errors
/// that follow without inputs: position errors · position + velocity errors · velocity.
struct TrackingLaw {
  Gain position, velocity;

  TrackingLaw() {
    constexpr double kVelocityWeight = 0.02;  // w [s]
    constexpr double kInputWeight = 1e-4;     // r [s²]
    const double h = to_seconds(kStep);
    Eigen::MatrixXd effect = Eigen::MatrixXd::Zero(2 * kHorizon, kHorizon);  // of each input
    for (int j = 0; j < kHorizon; ++j) {
      for (int i = j + 1; i < kHorizon; ++i) {
        effect(i, j) = h * h * (i - j - 0.5);
        effect(kHorizon + i, j) = kVelocityWeight * h;
      }
    }
    Eigen::MatrixXd normal = effect.transpose() * effect;
    normal.diagonal().array() += kInputWeight * kInputWeight;
    const Eigen::MatrixXd inputs = normal.partialPivLu().solve(effect.transpose());
    position = inputs.row(0).head<kHorizon>();
    velocity = kVelocityWeight * inputs.row(0).tail<kHorizon>();
  }
};

/// The simulated machine: a mass without friction.
struct Machine {
  Eigen::Vector2d x{0, 0}, v{0, 0};

  void step(const Eigen::Vector2d& u) {
    const double h = to_seconds(kStep);
    x += h * v + h * h / 2 * u;
    v += h * u;
  }
};

/// The input for the next step. All matrices have a fixed size or are views: nothing is allocated.
Eigen::Vector2d input(const Horizon& horizon, const TrackingLaw& law, const Machine& machine) {
  Errors position = horizon.position().topRows<2>();
  Errors velocity = horizon.velocity().topRows<2>();
  position.colwise() -= machine.x;
  velocity.colwise() -= machine.v;
  for (int i = 0; i < kHorizon; ++i) position.col(i) -= to_seconds(i * kStep) * machine.v;
  return position * law.position + velocity * law.velocity;
}

/// What the machine has done so far.
struct Record {
  int horizons = 0;
  double first = 0, last = 0, cost = 0;  // tracking errors [m]; ∫|error|² dt [m² s]

  void add(double error) {
    if (horizons++ == 0) first = error;
    last = error;
    cost += error * error * to_seconds(kStep);
  }
  void print() const {
    std::printf("%d horizons of %d states, tracking error %.4f m, at the end %.6f m, cost %.3g\n",
                horizons, kHorizon, first, last, cost);
  }
};

bool has_ended(const Reader& reader, Time now) {
  const auto progress = reader.progress();
  return progress && progress->is_finished && now > progress->newest;
}

void follow(Reader& reader) {
  const TrackingLaw law;
  Horizon horizon(kHorizon, reader.dimensions());
  Machine machine;
  Record record;
  Eigen::Vector2d u(0, 0);
  const MonotonicClock clock;
  Time now = clock.now();
  Eigen::internal::set_is_malloc_allowed(false);
  for (int tick = 0; tick < kTicks && !has_ended(reader, now); ++tick, now += kStep) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(now));  // CLOCK_MONOTONIC
    horizon.set_times(now, kStep);
    const std::uint64_t revision = reader.sample_many(horizon.times(), horizon);
    if (horizon.status()[0] == SampleStatus::retired) break;
    if (revision != 0 && horizon.is_complete()) {  // else no data yet, or busy: u remains
      const Eigen::Vector2d wanted = horizon.position().col(0).head<2>();
      if (record.horizons == 0) machine.x = wanted + Eigen::Vector2d(0.05, 0);
      record.add((machine.x - wanted).norm());
      u = input(horizon, law, machine);
    }
    machine.step(u);
  }
  Eigen::internal::set_is_malloc_allowed(true);
  record.print();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Reader reader(argc > 1 ? argv[1] : "arm", 10s);
    if (reader.dimensions() < 2) throw StreamError("the stream has one dimension, not x and y");
    follow(reader);
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
