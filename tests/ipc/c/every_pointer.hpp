#pragma once

#include <gtest/gtest.h>

#include <array>

#include "tests/ipc/c/roles.hpp"
#include "tests/ipc/c/wrong_pointers.hpp"

namespace splinecast::testing {

/// Calls of all functions with each of their pointers wrong.
class CPointers : public ::testing::Test {
 protected:
  CPointers() {
    c_.send(20);
    EXPECT_EQ(splinecast_snapshot_create(2, &snapshot_), 0);
    EXPECT_EQ(splinecast_reader_snapshot(c_.reader, 0, CStream::kStep, snapshot_), 0);
    EXPECT_EQ(splinecast_fit(&path_, nullptr, &curve_), 0) << splinecast_last_error();
    EXPECT_EQ(splinecast_rate_commander_create(law_.name().c_str(), "a", nullptr, &commander_), 0)
        << splinecast_last_error();
    EXPECT_EQ(splinecast_stopper_create(law_.name().c_str(), "a", nullptr, &stopper_), 0)
        << splinecast_last_error();
    add_general();
    add_producer();
    add_replacement();
    add_producer_state();
    add_producer_outputs();
    add_solver();
    add_reader();
    add_reader_outputs();
    add_many_samples();
    add_snapshot();
    add_curve();
    add_fit();
    add_rate_commander();
    add_stopper();
  }
  ~CPointers() override {
    EXPECT_EQ(splinecast_snapshot_destroy(snapshot_), 0);
    EXPECT_EQ(splinecast_curve_destroy(curve_), 0);
    EXPECT_EQ(splinecast_rate_commander_destroy(commander_), 0);
    EXPECT_EQ(splinecast_stopper_destroy(stopper_), 0);
  }

  template <typename Call>
  void producer(const char* function, const Call& call) {
    wrong_.handle<splinecast_producer>(function, "producer", call, c_.solver);
  }
  template <typename Call>
  void solver(const char* function, const Call& call) {
    wrong_.handle<splinecast_solver>(function, "solver", call, c_.reader);
  }
  template <typename Call>
  void reader(const char* function, const Call& call) {
    wrong_.handle<splinecast_reader>(function, "reader", call, c_.producer);
  }

  void add_general();
  void add_producer();
  void add_replacement();
  void add_old_end();
  void add_producer_state();
  void add_outcomes();
  void add_producer_outputs();
  void add_solver();
  void add_reader();
  void add_reader_outputs();
  void add_many_samples();
  void add_snapshot();
  void add_curve();
  void add_fit();
  void add_rate_commander();
  void add_stopper();

  TestStream law_;
  CStream c_;
  splinecast_snapshot* snapshot_ = nullptr;
  splinecast_curve* curve_ = nullptr;
  splinecast_rate_commander* commander_ = nullptr;
  splinecast_stopper* stopper_ = nullptr;
  WrongPointers wrong_;
  std::array<double, 2> values_{};
  std::array<std::int64_t, 1> times_{};
  splinecast_waypoint waypoint_ = {0, {values_.data(), 2, 1}, {}, {}};
  splinecast_waypoints path_ = {{times_.data(), 1, 1}, {values_.data(), 1, 2, 0, 0}, {}, {}};
  CState state_{2};
  std::int64_t time_ = 0;
  uint64_t number_ = 0;
  splinecast_outcome outcome_ = SPLINECAST_OUTCOME_INIT;
  size_t size_ = 0;
  splinecast_refusal refusal_ = {.item = 0,
                                 .time = 0,
                                 .reason = 1,
                                 .has_time = 0,
                                 .has_excess = 0,
                                 .reserved = 0,
                                 .excess = {},
                                 .by = {}};
  splinecast_limit_excess excess_ = {};
  splinecast_preview preview_ = SPLINECAST_PREVIEW_INIT;
  splinecast_excess place_ = {};
  std::array<char, 10> text_{};
  std::array<double, 8> block_{};
  std::array<uint8_t, 1> statuses_{};
  splinecast_times at_ = {times_.data(), 1, 1};
  splinecast_output_matrix matrix_ = {block_.data(), 1, 8, 0, 0};
  splinecast_segment segment_ = SPLINECAST_SEGMENT_INIT;
  splinecast_law_rate rate_ = {};
  splinecast_output output_ = {values_.data(), 2, 1};
};

// A function that takes only a handle, or a handle and where to write a number.
#define HANDLE_ONLY(role, name, ...) role(#name, [](auto* p) { return name(p __VA_ARGS__); })
#define HANDLE_AND_OUTPUT(role, type, name, argument, own, output) \
  role(#name, [this](auto* p) { return name(p, &output); });       \
  wrong_.pointer<type>(#name, argument, [this](auto* p) { return name(own, p); })

}  // namespace splinecast::testing
