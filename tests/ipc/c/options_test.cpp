#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/ipc/c/roles.hpp"
#include "tests/ipc/c/wrong_values.hpp"

/// Options of producers and solvers that are out of range. A change without a name is refused by
/// the library, whose message names the value.
namespace splinecast {
namespace {

using testing::CStream;
using testing::expect_refused;
using testing::kFar;
using testing::misaligned;

template <typename Options>
using Changes = std::vector<std::pair<std::string, std::function<void(Options&)>>>;

const std::array<const char*, 2> kNames{"x", nullptr};
const splinecast_dimension kKinds[3] = {{0, 0}, {4, 0}, {-1, 0}};
const double kValue = 1;

const Changes<splinecast_producer_options> kProducerChanges{
    {"options->size", [](splinecast_producer_options& o) { o.size = 0; }},
    {"options->size",
     [](splinecast_producer_options& o) {
       o.size = offsetof(splinecast_producer_options, law) - 8;
     }},
    {"options->size", [](splinecast_producer_options& o) { o.size = sizeof o + 1; }},
    {"options->size",
     [](splinecast_producer_options& o) { o.size = std::numeric_limits<size_t>::max() - 7; }},
    {"options->dimensions", [](splinecast_producer_options& o) { o.dimensions = 0; }},
    {"options->dimensions", [](splinecast_producer_options& o) { o.dimensions = 65; }},
    {"options->names",
     [](splinecast_producer_options& o) { o.names = kNames.data(), o.name_count = 1; }},
    {"options->names",
     [](splinecast_producer_options& o) { o.names = kNames.data(), o.name_count = 2; }},
    {"options->names", [](splinecast_producer_options& o) { o.name_count = 2; }},
    {"options->names",
     [](splinecast_producer_options& o) {
       o.names = misaligned(kNames.data());
       o.name_count = 2;
     }},
    {"options->units", [](splinecast_producer_options& o) { o.unit_count = 2; }},
    {"options->units",
     [](splinecast_producer_options& o) {
       o.units = kNames.data();
       o.unit_count = std::numeric_limits<size_t>::max();
     }},
    {"options->kinds", [](splinecast_producer_options& o) { o.kind_count = 2; }},
    {"options->kinds", [](splinecast_producer_options& o) { o.kinds = kKinds, o.kind_count = 1; }},
    {"options->kinds->kind",
     [](splinecast_producer_options& o) { o.kinds = kKinds, o.kind_count = 2; }},
    {"options->kinds->kind",
     [](splinecast_producer_options& o) { o.kinds = kKinds + 1, o.kind_count = 2; }},
    {"options->kinds",
     [](splinecast_producer_options& o) { o.kinds = misaligned(kKinds), o.kind_count = 2; }},
    {"options->clock", [](splinecast_producer_options& o) { o.clock = 3; }},
    {"", [](splinecast_producer_options& o) { o.clock = SPLINECAST_CLOCK_LAW; }},
    {"", [](splinecast_producer_options& o) { o.law = "c.no-law"; }},
    {"", [](splinecast_producer_options& o) { o.clock = SPLINECAST_CLOCK_LAW, o.law = "no/law"; }},
    {"options->clock", [](splinecast_producer_options& o) { o.clock = -1; }},
    {"options->start", [](splinecast_producer_options& o) { o.start.kind = -1; }},
    {"options->start", [](splinecast_producer_options& o) { o.start.kind = 8; }},
    {"options->start",
     [](splinecast_producer_options& o) {
       o.start = {SPLINECAST_VELOCITY, {&kValue, 1, 1}};
     }},
    {"options->mode", [](splinecast_producer_options& o) { o.mode = 01000; }},
    {"options->group", [](splinecast_producer_options& o) { o.group = -2; }},
    {"options->group", [](splinecast_producer_options& o) { o.group = std::int64_t{1} << 40; }},
    {"options->owner", [](splinecast_producer_options& o) { o.owner = std::int64_t{0xffffffff}; }},
    {"", [](splinecast_producer_options& o) { o.start.kind = SPLINECAST_PERIODIC; }},
    {"", [](splinecast_producer_options& o) { o.min_interval = 0; }},
    {"",
     [](splinecast_producer_options& o) {
       o.max_interval = std::numeric_limits<std::int64_t>::max();
     }},
    {"",
     [](splinecast_producer_options& o) {
       o.min_interval = std::numeric_limits<std::int64_t>::min();
     }},
    {"", [](splinecast_producer_options& o) { o.horizon = 0; }},
    {"", [](splinecast_producer_options& o) { o.start_tolerance = -1e-9; }},
    {"",
     [](splinecast_producer_options& o) {
       o.start_tolerance = std::numeric_limits<double>::infinity();
     }},
    {"", [](splinecast_producer_options& o) { o.capacity = 1; }},
    {"", [](splinecast_producer_options& o) { o.capacity = std::numeric_limits<size_t>::max(); }}};

const std::array<double, 2> kValues{1, -1};
const splinecast_named_limits kUnnamed = {nullptr, 0, 0, 0, 0, 0};

/// A change that gives limits of the velocity.
std::function<void(splinecast_solver_options&)> limited(const splinecast_vector& velocity) {
  return [velocity](splinecast_solver_options& options) {
    static splinecast_limits limits;
    limits = SPLINECAST_LIMITS_INIT;
    limits.velocity = velocity;
    options.limits = &limits;
  };
}

const Changes<splinecast_solver_options> kSolverChanges{
    {"options->size", [](splinecast_solver_options& o) { o.size = 8; }},
    {"options->method", [](splinecast_solver_options& o) { o.method = "cubic"; }},
    {"", [](splinecast_solver_options& o) { o.method = "normalized"; }},
    {"options->lambda", [](splinecast_solver_options& o) { o.lambda = -2; }},
    {"options->lambda",
     [](splinecast_solver_options& o) { o.lambda = std::numeric_limits<double>::quiet_NaN(); }},
    {"options->time_scale", [](splinecast_solver_options& o) { o.time_scale = -1.5; }},
    {"options->settle", [](splinecast_solver_options& o) { o.settle = -2; }},
    {"", [](splinecast_solver_options& o) { o.settle = 65; }},
    {"options->tail", [](splinecast_solver_options& o) { o.tail = 4; }},
    {"options->tail", [](splinecast_solver_options& o) { o.tail = -2; }},
    {"options->beyond", [](splinecast_solver_options& o) { o.beyond = 3; }},
    {"options->force_lag", [](splinecast_solver_options& o) { o.force_lag = 2; }},
    {"options->wake", [](splinecast_solver_options& o) { o.wake = -1; }},
    {"options->stop_time", [](splinecast_solver_options& o) { o.stop_time = -2; }},
    {"",
     [](splinecast_solver_options& o) { o.stop_time = std::numeric_limits<std::int64_t>::max(); }},
    {"options->freeze_ahead", [](splinecast_solver_options& o) { o.freeze_ahead = -2; }},
    {"options->history", [](splinecast_solver_options& o) { o.history = -2; }},
    {"options->min_entry", [](splinecast_solver_options& o) { o.min_entry = -2; }},
    {"options->largest_rate", [](splinecast_solver_options& o) { o.largest_rate = -2; }},
    {"", [](splinecast_solver_options& o) { o.largest_rate = 0; }},
    {"", [](splinecast_solver_options& o) { o.largest_rate = 101; }},
    {"options->capacity", [](splinecast_solver_options& o) { o.capacity = -2; }},
    {"",
     [](splinecast_solver_options& o) { o.capacity = std::numeric_limits<std::int64_t>::max(); }},
    {"options->reserved", [](splinecast_solver_options& o) { o.reserved = 1; }},
    {"options->mode", [](splinecast_solver_options& o) { o.mode = 0xffffffffU; }},
    {"options->owner", [](splinecast_solver_options& o) { o.owner = -3; }},
    {"options->named_limits", [](splinecast_solver_options& o) { o.named_limit_count = 1; }},
    {"options->named_limits->name",
     [](splinecast_solver_options& o) { o.named_limits = &kUnnamed, o.named_limit_count = 1; }},
    {"options->named_limits",
     [](splinecast_solver_options& o) { o.named_limits = &kUnnamed, o.named_limit_count = 5000; }},
    {"options->limits->velocity", limited({nullptr, 1, 1})},
    {"options->limits->velocity", limited({kValues.data(), 0, 1})},
    {"options->limits->velocity", limited({kValues.data(), 65, 1})},
    {"options->limits->velocity", limited({kValues.data(), 2, kFar})},
    {"options->limits->velocity", limited({misaligned(kValues.data()), 1, 1})},
    {"", limited({kValues.data(), 2, 1})}};

TEST(COptions, OfAProducerAreInRange) {
  const testing::TestStream stream;
  splinecast_producer* producer = nullptr;
  for (std::size_t i = 0; i < kProducerChanges.size(); ++i) {
    const auto& [name, change] = kProducerChanges[i];
    splinecast_producer_options options = CStream::recorded();
    change(options);
    expect_refused(name, std::to_string(i),
                   splinecast_producer_create(stream.name().c_str(), &options, &producer));
    EXPECT_EQ(producer, nullptr);
  }
  expect_refused("", "name", splinecast_producer_create("a/b", nullptr, &producer));
}

TEST(COptions, OfASolverAreInRange) {
  const testing::TestStream stream;
  splinecast_solver* solver = nullptr;
  for (std::size_t i = 0; i < kSolverChanges.size(); ++i) {
    const auto& [name, change] = kSolverChanges[i];
    splinecast_solver_options options = SPLINECAST_SOLVER_OPTIONS_INIT;
    change(options);
    expect_refused(name, std::to_string(i),
                   splinecast_solver_create(stream.name().c_str(), &options, &solver));
    EXPECT_EQ(solver, nullptr);
  }
  splinecast_limits limits = SPLINECAST_LIMITS_INIT;
  limits.size = 3;
  splinecast_solver_options options = SPLINECAST_SOLVER_OPTIONS_INIT;
  options.limits = &limits;
  expect_refused("options->limits->size", "size",
                 splinecast_solver_create(stream.name().c_str(), &options, &solver));
}
}  // namespace
}  // namespace splinecast
