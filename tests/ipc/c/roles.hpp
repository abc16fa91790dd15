#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "splinecast.h"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {

/// A recorded stream of two dimensions with its three roles, made through the C interface.
struct CStream {
  static constexpr std::int64_t kStep = 100'000'000;

  TestStream stream;
  splinecast_producer* producer = nullptr;
  splinecast_solver* solver = nullptr;
  splinecast_reader* reader = nullptr;

  explicit CStream(splinecast_producer_options options = recorded(),
                   splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT) {
    EXPECT_EQ(splinecast_producer_create(name(), &options, &producer), 0)
        << splinecast_last_error();
    EXPECT_EQ(splinecast_solver_create(name(), &how, &solver), 0) << splinecast_last_error();
    EXPECT_EQ(splinecast_solver_attach(solver), 1) << splinecast_last_error();
    EXPECT_EQ(splinecast_reader_create(name(), 0, nullptr, &reader), 0) << splinecast_last_error();
  }
  CStream(const CStream&) = delete;
  CStream& operator=(const CStream&) = delete;
  ~CStream() {
    EXPECT_EQ(splinecast_reader_destroy(reader), 0);
    EXPECT_EQ(splinecast_solver_destroy(solver), 0);
    EXPECT_EQ(splinecast_producer_destroy(producer), 0);
  }

  [[nodiscard]] const char* name() const { return stream.name().c_str(); }

  static splinecast_producer_options recorded() {
    splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
    options.dimensions = 2;
    options.clock = SPLINECAST_CLOCK_RECORDED;
    options.start.kind = SPLINECAST_NATURAL;
    return options;
  }

  int append(std::int64_t t, double x, double y) const {
    const double position[2] = {x, y};
    const splinecast_waypoint waypoint = {t, {position, 2, 1}, {}, {}};
    return splinecast_producer_append(producer, &waypoint);
  }
  void solve() const {
    constexpr int kMostSteps = 100'000;
    for (int i = 0; i < kMostSteps && splinecast_solver_step(solver, nullptr) > 0; ++i) {
    }
  }
  /// Appends a path of `count` waypoints and solves it.
  void send(int count) const {
    for (int i = 0; i < count; ++i) {
      ASSERT_EQ(append(i * kStep, 0.1 * i * i, 1 - 0.2 * i), SPLINECAST_APPEND_ACCEPTED);
    }
    solve();
  }
  void finish() const {
    const splinecast_condition end = {SPLINECAST_NATURAL, {}};
    ASSERT_EQ(splinecast_producer_finish(producer, &end), SPLINECAST_APPEND_ACCEPTED);
    solve();
  }
};

/// Contiguous memory for a state of `dimensions` values.
struct CState {
  std::vector<double> values;
  splinecast_state state;

  explicit CState(std::size_t dimensions)
      : values(4 * dimensions),
        state{part(0, dimensions), part(1, dimensions), part(2, dimensions), part(3, dimensions)} {}

 private:
  splinecast_output part(std::size_t r, std::size_t dimensions) {
    return {values.data() + r * dimensions, dimensions, 1};
  }
};

}  // namespace splinecast::testing
