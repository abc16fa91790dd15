#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/ipc/c/roles.hpp"
#include "tests/ipc/c/wrong_values.hpp"

/// Arrays that are short, long, misaligned or beyond memory, and numbers out of range.
namespace splinecast {
namespace {

using testing::CState;
using testing::CStream;
using testing::expect_refused;
using testing::kFar;
using testing::misaligned;
using testing::try_matrix;
using testing::try_vector;

TEST(CValues, OfAWaypointAreOnePerDimension) {
  const CStream c;
  const std::array<double, 4> values{};
  splinecast_waypoint waypoint = {
      1, {values.data(), 2, 1}, {values.data(), 2, 1}, {values.data(), 2, 1}};
  const auto append = [&] { return splinecast_producer_append(c.producer, &waypoint); };
  try_vector("waypoint->position", waypoint.position, append);
  try_vector("waypoint->velocity", waypoint.velocity, append);
  try_vector("waypoint->acceleration", waypoint.acceleration, append);
  const auto start = [&] { return splinecast_producer_start_from(c.producer, &waypoint); };
  try_vector("state->position", waypoint.position, start);
  try_vector("state->velocity", waypoint.velocity, start);
  try_vector("state->acceleration", waypoint.acceleration, start);
  for (splinecast_vector* vector :
       {&waypoint.acceleration, &waypoint.velocity, &waypoint.position}) {
    *vector = {};
    expect_refused("state->", "not given", start());
  }
  expect_refused("waypoint->position", "not given", append());
  uint64_t items = 9;
  EXPECT_EQ(splinecast_producer_appended(c.producer, &items), 0);
  EXPECT_EQ(items, 0U);
}

TEST(CValues, OfWaypointsAreOneRowPerTime) {
  const CStream c;
  const std::array<std::int64_t, 4> times{0, 1'000'000, 2'000'000, 3'000'000};
  const std::array<double, 16> values{};
  const splinecast_matrix matrix = {values.data(), 3, 2, 0, 0};
  splinecast_waypoints path = {{times.data(), 3, 1}, matrix, matrix, matrix};
  splinecast_preview preview = SPLINECAST_PREVIEW_INIT;
  splinecast_curve* curve = nullptr;
  double lambda = 0;
  const std::vector<std::function<int()>> calls{
      [&] { return splinecast_producer_append_many(c.producer, &path, nullptr); },
      [&] { return splinecast_producer_replace_from(c.producer, 0, &path, 0); },
      [&] { return splinecast_producer_preview_replace(c.producer, 0, &path, 0, &preview); },
      [&] { return splinecast_fit(&path, nullptr, &curve); },
      [&] { return splinecast_cross_validated_lambda(&path, &lambda); }};
  for (const auto& call : calls) {
    try_vector("waypoints->", path.times, call);
    try_matrix("waypoints->", path.positions, call);
    try_matrix("waypoints->velocities", path.velocities, call);
    try_matrix("waypoints->accelerations", path.accelerations, call);
    path.positions = {};
    expect_refused("waypoints->positions", "not given", call());
    path.positions = matrix;
  }
  EXPECT_EQ(curve, nullptr);
}

TEST(CValues, OfAFitAreInRange) {
  std::array<std::int64_t, 2> times{0, 1'000'000};
  std::array<double, 70> values{};
  splinecast_waypoints path = {{times.data(), 2, 1}, {values.data(), 2, 1, 0, 0}, {}, {}};
  splinecast_curve* curve = nullptr;
  const auto fit = [&] { return splinecast_fit(&path, nullptr, &curve); };
  for (const std::int64_t time :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    times = {0, time};
    expect_refused("waypoints->times", "far", fit());
  }
  times = {5, 5};
  expect_refused("time of waypoint 1", "twice", fit());
  times = {0, 1};
  values[1] = std::numeric_limits<double>::quiet_NaN();
  expect_refused("position of waypoint 1", "NaN", fit());
  values[1] = 0;
  path.positions = {values.data(), 1, 65, 0, 0};
  expect_refused("waypoints->positions", "65 dimensions", fit());
}

TEST(CValues, OfTheOptionsOfAFitAreInRange) {
  const std::array<std::int64_t, 2> times{0, 1};
  std::array<double, 2> values{};
  const splinecast_waypoints path = {{times.data(), 2, 1}, {values.data(), 2, 1, 0, 0}, {}, {}};
  splinecast_fit_options options = SPLINECAST_FIT_OPTIONS_INIT;
  splinecast_curve* curve = nullptr;
  const auto fit = [&] { return splinecast_fit(&path, &options, &curve); };
  options.method = "cubic";
  expect_refused("options->method", "unknown", fit());
  options.method = nullptr;
  for (const int kind : {-1, 8, std::numeric_limits<int>::min()}) {
    options.start.kind = kind;
    expect_refused("options->start", "kind", fit());
  }
  options.start.kind = SPLINECAST_VELOCITY;
  EXPECT_EQ(fit(), SPLINECAST_ERROR_ARGUMENT);
  options.start.value = {values.data(), 1, 1};
  try_vector("options->start", options.start.value, fit);
  options.end = {SPLINECAST_ACCELERATION, {values.data(), 1, 1}};
  try_vector("options->end", options.end.value, fit);
  ASSERT_EQ(fit(), 0) << splinecast_last_error();
  EXPECT_EQ(splinecast_curve_destroy(curve), 0);
}

TEST(CValues, OfACurveAreInRange) {
  const std::array<std::int64_t, 2> times{0, 1};
  std::array<double, 2> values{};
  const splinecast_waypoints path = {{times.data(), 2, 1}, {values.data(), 2, 1, 0, 0}, {}, {}};
  splinecast_curve* curve = nullptr;
  ASSERT_EQ(splinecast_fit(&path, nullptr, &curve), 0) << splinecast_last_error();
  CState state(1);
  splinecast_output out = {values.data(), 1, 1};
  for (const std::int64_t t : {std::int64_t{-1}, std::int64_t{2}}) {
    expect_refused("t is", "outside", splinecast_curve_evaluate(curve, t, &state.state));
    expect_refused("t is", "outside", splinecast_curve_derivative(curve, t, 0, &out));
  }
  for (const int r : {-1, 16, std::numeric_limits<int>::max()}) {
    expect_refused("r is", "outside", splinecast_curve_derivative(curve, 0, r, &out));
  }
  try_vector("out", out, [&] { return splinecast_curve_derivative(curve, 0, 0, &out); });
  splinecast_segment segment = SPLINECAST_SEGMENT_INIT;
  expect_refused("i is", "outside", splinecast_curve_segment(curve, 1, &segment));
  expect_refused("i is", "outside",
                 splinecast_curve_segment(curve, std::numeric_limits<size_t>::max(), &segment));
  EXPECT_EQ(splinecast_curve_destroy(curve), 0);
}

TEST(CValues, OfAStateAreOnePerDimension) {
  const CStream c;
  c.send(20);
  CState found(2);
  splinecast_state& state = found.state;
  splinecast_excess excess = {};
  splinecast_curve* curve = nullptr;
  const std::int64_t time = 0;
  const splinecast_waypoints path = {{&time, 1, 1}, {found.values.data(), 1, 2, 0, 0}, {}, {}};
  ASSERT_EQ(splinecast_fit(&path, nullptr, &curve), 0);
  const std::vector<std::pair<std::string, std::function<int()>>> calls{
      {"out", [&] { return splinecast_reader_sample(c.reader, 0, &state); }},
      {"out", [&] { return splinecast_reader_preview(c.reader, 0, &state); }},
      {"out", [&] { return splinecast_curve_evaluate(curve, 0, &state); }},
      {"sampled", [&] { return splinecast_reader_excess(c.reader, &state, &excess); }}};
  for (const auto& [name, call] : calls) {
    try_vector(name + "->position", state.position, call);
    try_vector(name + "->velocity", state.velocity, call);
    try_vector(name + "->acceleration", state.acceleration, call);
    try_vector(name + "->jerk", state.jerk, call);
  }
  state.jerk = {};
  expect_refused("sampled->jerk", "not given", calls.back().second());
  EXPECT_EQ(splinecast_curve_destroy(curve), 0);
}

TEST(CValues, OfManySamplesAreOneRowPerTime) {
  const CStream c;
  c.send(20);
  const std::array<std::int64_t, 4> at{0, 1, 2, 3};
  std::array<double, 40> values{};
  std::array<uint8_t, 4> statuses{};
  splinecast_times times = {at.data(), 3, 1};
  splinecast_output_matrix matrix = {values.data(), 3, 8, 0, 0};
  int derivatives = 15;
  size_t count = 3;
  const auto call = [&] {
    return splinecast_reader_sample_many(c.reader, &times, derivatives, &matrix, statuses.data(),
                                         count, nullptr);
  };
  ASSERT_EQ(call(), 1);
  try_matrix("values", matrix, call);
  for (const int wrong : {0, -1, 16, std::numeric_limits<int>::max()}) {
    derivatives = wrong;
    expect_refused("derivatives", "outside", call());
  }
  derivatives = 15;
  for (const size_t wrong : {size_t{2}, size_t{4}, std::numeric_limits<size_t>::max()}) {
    count = wrong;
    expect_refused("statuses", "count", call());
  }
  count = 3;
  times = {misaligned(at.data()), 3, 1};
  expect_refused("times", "misaligned", call());
  times = {nullptr, 3, 1};
  expect_refused("times", "null", call());
  times = {at.data(), 3, kFar};
  expect_refused("times", "far", call());
}

TEST(CValues, OfAPreviewAreOnePerDimension) {
  const CStream c;
  c.send(20);
  std::array<double, 4> memory{};
  splinecast_preview preview = SPLINECAST_PREVIEW_INIT;
  const auto call = [&] {
    return splinecast_producer_preview_replace(c.producer, 19 * CStream::kStep, nullptr, 0,
                                               &preview);
  };
  const std::vector<std::pair<std::string, splinecast_output splinecast_preview::*>> outputs{
      {"out->entry_velocity", &splinecast_preview::entry_velocity},
      {"out->entry_acceleration", &splinecast_preview::entry_acceleration},
      {"out->entry_jerk", &splinecast_preview::entry_jerk},
      {"out->motion_velocity", &splinecast_preview::motion_velocity},
      {"out->motion_acceleration", &splinecast_preview::motion_acceleration},
      {"out->motion_jerk", &splinecast_preview::motion_jerk}};
  for (const auto& [name, member] : outputs) {
    preview.*member = {memory.data(), 2, 1};
    try_vector(name, preview.*member, call);
  }
  EXPECT_EQ(call(), 0);
}

TEST(CValues, OfOtherArgumentsAreInRange) {
  const CStream c;
  c.send(20);
  splinecast_snapshot* snapshot = nullptr;
  for (const size_t dimensions : {size_t{0}, size_t{65}, std::numeric_limits<size_t>::max()}) {
    expect_refused("dimensions", "", splinecast_snapshot_create(dimensions, &snapshot));
  }
  ASSERT_EQ(splinecast_snapshot_create(3, &snapshot), 0);
  expect_refused("out has 3", "", splinecast_reader_snapshot(c.reader, 0, 1, snapshot));
  splinecast_segment segment = SPLINECAST_SEGMENT_INIT;
  expect_refused("i is", "", splinecast_snapshot_segment(snapshot, 0, &segment));
  EXPECT_EQ(splinecast_snapshot_destroy(snapshot), 0);
  splinecast_dimension kind = {};
  expect_refused("dimension is", "", splinecast_reader_kind(c.reader, 2, &kind));
  EXPECT_EQ(splinecast_reader_name(c.reader, 2), nullptr);
  EXPECT_EQ(splinecast_reader_unit(c.reader, std::numeric_limits<size_t>::max()), nullptr);
  EXPECT_EQ(splinecast_reader_kind_text(c.reader, 2), nullptr);
  splinecast_reader* reader = nullptr;
  splinecast_reader_options options = SPLINECAST_READER_OPTIONS_INIT;
  options.times = std::numeric_limits<size_t>::max();
  expect_refused("options->times", "", splinecast_reader_create(c.name(), 0, &options, &reader));
  options = SPLINECAST_READER_OPTIONS_INIT;
  options.owner = -2;
  expect_refused("options->owner", "", splinecast_reader_create(c.name(), 0, &options, &reader));
  const splinecast_condition live_end = {8, {}};
  expect_refused("end", "", splinecast_producer_finish(c.producer, &live_end));
  const double value = 0;
  const splinecast_condition short_end = {SPLINECAST_VELOCITY, {&value, 1, 1}};
  expect_refused("end", "", splinecast_producer_finish(c.producer, &short_end));
}

TEST(CValues, OfRefusalsAreInRange) {
  const CStream c;
  c.send(20);
  splinecast_refusal item = {};
  splinecast_refusals out = SPLINECAST_REFUSALS_INIT;
  const auto producer = [&] { return splinecast_producer_refusals(c.producer, &out); };
  const auto solver = [&] { return splinecast_solver_first_refusals(c.solver, &out); };
  for (const std::function<int()>& call : {std::function<int()>(producer), {solver}}) {
    out = SPLINECAST_REFUSALS_INIT;
    out.capacity = 1;
    expect_refused("out->items", "null", call());
    out.items = misaligned(&item);
    expect_refused("out->items", "misaligned", call());
    out.items = &item;
    for (const size_t size : {size_t{0}, sizeof item - 8, sizeof item + 1, size_t{1} << 40U}) {
      out.item_size = size;
      expect_refused("out->item_size", "", call());
    }
    out.item_size = sizeof item;
    out.capacity = std::numeric_limits<size_t>::max();
    expect_refused("out->capacity", "", call());
  }
  for (const int reason : {-1, 0, SPLINECAST_REFUSAL_STOPPED + 1}) {
    item.reason = reason;
    expect_refused("refusal->reason", "", splinecast_refusal_message(&item, nullptr, 0));
  }
  item.reason = SPLINECAST_REFUSAL_BEYOND_LIMITS;
  item.has_time = 2;
  expect_refused("refusal->has_time", "", splinecast_refusal_message(&item, nullptr, 0));
  item.has_time = 0;
  item.has_excess = 1;
  item.excess.kind = 4;
  expect_refused("refusal->excess", "", splinecast_refusal_message(&item, nullptr, 0));
  item.excess = {};
  item.excess.dimension = 64;
  expect_refused("excess", "", splinecast_excess_message(&item.excess, nullptr, nullptr, 0));
}

TEST(CValues, TimesAtTheEndsOfTheRangeDoNotFail) {
  const CStream c;
  c.send(20);
  CState state(2);
  splinecast_snapshot* snapshot = nullptr;
  ASSERT_EQ(splinecast_snapshot_create(2, &snapshot), 0);
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t t : {kLeast, kMost}) {
    EXPECT_GE(splinecast_reader_sample(c.reader, t, &state.state), 0);
    EXPECT_GE(splinecast_reader_preview(c.reader, t, &state.state), 0);
    EXPECT_GE(splinecast_reader_snapshot(c.reader, t, t, snapshot), 0);
    EXPECT_EQ(c.append(t, 0, 0), SPLINECAST_APPEND_TOO_FAR_APART);
    EXPECT_GE(splinecast_producer_replace_from(c.producer, t, nullptr, t), 0);
  }
  EXPECT_GE(splinecast_reader_snapshot(c.reader, kLeast, kMost, snapshot), 0);
  EXPECT_EQ(splinecast_producer_wait_for_solver(c.producer, kLeast), 1);
  EXPECT_EQ(splinecast_producer_wait_for_room(c.producer, kMost), 1);
  EXPECT_EQ(splinecast_solver_wait(c.solver, kLeast), 0);
  ASSERT_EQ(c.append(20 * CStream::kStep, 0, 0), SPLINECAST_APPEND_ACCEPTED);
  c.solve();
  EXPECT_EQ(splinecast_reader_wait(c.reader, kMost), SPLINECAST_WAIT_ADVANCED);
  EXPECT_EQ(splinecast_reader_wait(c.reader, kLeast), SPLINECAST_WAIT_TIMED_OUT);
  EXPECT_EQ(splinecast_snapshot_destroy(snapshot), 0);
}

TEST(CValues, AReplacementWithoutRoomIsTooMany) {
  const CStream c;
  const std::size_t many = (std::size_t{1} << 24U) + 1;
  const std::vector<std::int64_t> times(many);
  const std::vector<double> values(many + 1);
  const splinecast_waypoints path = {
      {times.data(), many, 1}, {values.data(), many, 2, 1, 1}, {}, {}};  // rows may overlap
  EXPECT_EQ(splinecast_producer_replace_from(c.producer, 0, &path, 0), SPLINECAST_APPEND_TOO_MANY);
}

}  // namespace
}  // namespace splinecast
