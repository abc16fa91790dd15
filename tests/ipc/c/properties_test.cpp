#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "ipc/c/roles.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/ipc/c/roles.hpp"

/// What the C interface reports about streams, and how.
namespace splinecast {
namespace {

using testing::CState;
using testing::CStream;

TEST(CProperties, OfAStreamAreThoseThatItsProducerSet) {
  const std::array<const char*, 2> names{"x", "turn"};
  const std::array<const char*, 2> units{"m", "rad"};
  const std::array<splinecast_dimension, 2> kinds{splinecast_dimension{SPLINECAST_LINEAR, 0},
                                                  {SPLINECAST_PERIODIC_VALUE, 6.25}};
  splinecast_producer_options options = CStream::recorded();
  options.names = names.data();
  options.units = units.data();
  options.kinds = kinds.data();
  options.name_count = options.unit_count = options.kind_count = 2;
  const CStream c(options);
  EXPECT_EQ(splinecast_reader_dimensions(c.reader), 2);
  EXPECT_EQ(splinecast_reader_clock(c.reader), SPLINECAST_CLOCK_RECORDED);
  EXPECT_STREQ(splinecast_reader_name(c.reader, 1), "turn");
  EXPECT_STREQ(splinecast_reader_unit(c.reader, 0), "m");
  EXPECT_STREQ(splinecast_reader_kind_text(c.reader, 0), "linear");
  EXPECT_STREQ(splinecast_reader_kind_text(c.reader, 1), "periodic:6.25");
  splinecast_dimension kind = {};
  EXPECT_EQ(splinecast_reader_kind(c.reader, 1, &kind), 0);
  EXPECT_EQ(kind.kind, SPLINECAST_PERIODIC_VALUE);
  EXPECT_EQ(kind.period, 6.25);
  EXPECT_EQ(splinecast_reader_alive(c.reader), SPLINECAST_PRODUCER_ALIVE | SPLINECAST_SOLVER_ALIVE);
  EXPECT_EQ(splinecast_reader_is_memory_locked(c.reader),
            c.reader->reader.is_memory_locked() ? 1 : 0);
  const CStream plain;
  EXPECT_STREQ(splinecast_reader_name(plain.reader, 1), "");
}

TEST(CProperties, TheOptionsOfTheSolverReachTheBoard) {
  const std::array<double, 2> velocity{3, 4};
  splinecast_limits limits = SPLINECAST_LIMITS_INIT;
  limits.velocity = {velocity.data(), 2, 1};
  splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT;
  how.limits = &limits;
  how.method = "akima";
  how.stop_time = 123'000'000;
  const CStream c(CStream::recorded(), how);
  splinecast_limits found = SPLINECAST_LIMITS_INIT;
  ASSERT_EQ(splinecast_reader_limits(c.reader, &found), 0);
  ASSERT_EQ(found.velocity.count, 2U);
  EXPECT_EQ(found.velocity.data[1], 4);
  EXPECT_EQ(found.jerk.data, nullptr);
  c.send(20);
  CState state(2);
  ASSERT_TRUE(splinecast_has_values(splinecast_reader_sample(c.reader, 1, &state.state)));
  splinecast_excess excess = {};
  ASSERT_EQ(splinecast_reader_excess(c.reader, &state.state, &excess), 0);
  EXPECT_EQ(excess.kind, SPLINECAST_LIMIT_VELOCITY);
  EXPECT_EQ(excess.ratio,
            std::abs(state.values[2 + excess.dimension]) / velocity[excess.dimension]);
}

TEST(CProperties, TheCountsOfTheRolesAreThoseOfTheClasses) {
  const CStream c;
  splinecast_progress progress = SPLINECAST_PROGRESS_INIT;
  std::int64_t first = 7;
  EXPECT_EQ(splinecast_reader_progress(c.reader, &progress), 0);
  EXPECT_EQ(splinecast_reader_first_time(c.reader, &first), 0);
  EXPECT_EQ(first, 7);
  c.send(20);
  ASSERT_EQ(splinecast_reader_progress(c.reader, &progress), 1);
  EXPECT_EQ(progress.waypoints, 20U);
  EXPECT_EQ(progress.newest, 19 * CStream::kStep);
  EXPECT_EQ(progress.is_finished, 0);
  EXPECT_EQ(splinecast_reader_first_time(c.reader, &first), 1);
  EXPECT_EQ(first, 0);
  EXPECT_EQ(splinecast_reader_wait(c.reader, 0), SPLINECAST_WAIT_ADVANCED);
  EXPECT_EQ(splinecast_reader_wait(c.reader, -1), SPLINECAST_WAIT_TIMED_OUT);
  uint64_t items = 0;
  std::int64_t time = 0;
  EXPECT_EQ(splinecast_producer_appended(c.producer, &items), 0);
  EXPECT_EQ(items, 20U);
  EXPECT_EQ(splinecast_producer_wait_until_consumed(c.producer, 0), 1);
  EXPECT_EQ(splinecast_producer_consumed(c.producer, &items), 0);
  EXPECT_EQ(items, 20U);
  EXPECT_EQ(splinecast_producer_last_time(c.producer, &time), 0);
  EXPECT_EQ(time, 19 * CStream::kStep);
  EXPECT_EQ(splinecast_producer_earliest(c.producer, &time), 0);
  EXPECT_EQ(time, c.producer->producer.earliest().count());
  EXPECT_EQ(splinecast_producer_stream_id(c.producer, &items), 0);
  EXPECT_EQ(items, c.producer->producer.stream_id());
  EXPECT_EQ(splinecast_solver_due(c.solver, &time), 0);
  EXPECT_EQ(time, c.solver->solver.due().count());
}

TEST(CProperties, TheStatesOfTheRolesAreThoseOfTheClasses) {
  const CStream c;
  c.send(20);
  EXPECT_EQ(splinecast_producer_continues(c.producer), 0);
  EXPECT_EQ(splinecast_producer_solver_alive(c.producer), 1);
  EXPECT_EQ(splinecast_producer_wait_for_solver(c.producer, 0), 1);
  EXPECT_EQ(splinecast_producer_wait_for_room(c.producer, 0), 1);
  EXPECT_EQ(splinecast_producer_is_memory_locked(c.producer),
            c.producer->producer.is_memory_locked() ? 1 : 0);
  EXPECT_EQ(splinecast_solver_attached(c.solver), 1);
  EXPECT_EQ(splinecast_solver_took_over(c.solver), 0);
  EXPECT_EQ(splinecast_solver_is_memory_locked(c.solver),
            c.solver->solver.is_memory_locked() ? 1 : 0);
  EXPECT_EQ(splinecast_solver_wait(c.solver, 0), 0);
}

TEST(CProperties, AStepReportsWhatItDid) {
  const CStream c;
  ASSERT_EQ(c.append(0, 1, 2), SPLINECAST_APPEND_ACCEPTED);
  splinecast_step_result step = SPLINECAST_STEP_RESULT_INIT;
  EXPECT_EQ(splinecast_solver_step(c.solver, &step), 1);
  EXPECT_EQ(step.consumed, 1U);
  EXPECT_EQ(step.published, 1);
  EXPECT_EQ(step.damaged, 0);
  EXPECT_EQ(splinecast_solver_step(c.solver, &step), 0);
  EXPECT_EQ(step.consumed, 0U);
}

TEST(CProperties, RefusalsWithoutRoomAreLeftForTheNextCall) {
  splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT;
  how.method = "hermite";
  const CStream c(CStream::recorded(), how);
  c.send(5);
  std::array<splinecast_refusal, 2> items{};
  splinecast_refusals found = SPLINECAST_REFUSALS_INIT;
  EXPECT_EQ(splinecast_producer_refusals(c.producer, &found), 0);
  EXPECT_EQ(found.consumed, 0U);
  found.items = items.data();
  found.capacity = 2;
  for (const std::uint64_t first : {0U, 2U, 4U}) {
    const int count = splinecast_producer_refusals(c.producer, &found);
    ASSERT_EQ(count, first < 4 ? 2 : 1);
    EXPECT_EQ(found.count, static_cast<size_t>(count));
    EXPECT_EQ(items[0].item, first);
    EXPECT_EQ(items[0].has_time, 1);
    EXPECT_EQ(items[0].time, static_cast<std::int64_t>(first) * CStream::kStep);
    EXPECT_EQ(items[0].reason, SPLINECAST_REFUSAL_LACKS_DERIVATIVES);
    EXPECT_EQ(found.consumed, first < 4 ? first + 2 : 5U);
  }
  EXPECT_EQ(splinecast_producer_refusals(c.producer, &found), 0);
  std::array<char, 20> text{};
  const std::string whole = "item 4 refused: lacks derivatives (time 400000000 ns)";
  EXPECT_EQ(splinecast_refusal_message(items.data(), text.data(), text.size()),
            static_cast<int>(whole.size()));
  EXPECT_EQ(std::string(text.data()), whole.substr(0, text.size() - 1));
  EXPECT_EQ(splinecast_refusal_message(items.data(), nullptr, 0), static_cast<int>(whole.size()));
  EXPECT_EQ(splinecast_solver_first_refusals(c.solver, &found), 1);
  EXPECT_EQ(items[0].item, 0U);
  EXPECT_EQ(splinecast_solver_first_refusals(c.solver, &found), 0);
}

TEST(CProperties, TheFirstExcessIsReportedOnce) {
  const double most = 1e-3;
  splinecast_limits limits = SPLINECAST_LIMITS_INIT;
  limits.velocity = {&most, 1, 0};
  splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT;
  how.limits = &limits;
  const CStream c(CStream::recorded(), how);
  c.send(20);
  splinecast_limit_excess excess = {};
  ASSERT_EQ(splinecast_solver_first_excess(c.solver, &excess), 1);
  EXPECT_EQ(excess.kind, SPLINECAST_LIMIT_VELOCITY);
  EXPECT_EQ(excess.limit, most);
  EXPECT_EQ(excess.is_refused, 0);
  EXPECT_EQ(splinecast_solver_first_excess(c.solver, &excess), 0);
  std::array<char, 200> text{};
  EXPECT_GT(splinecast_excess_message(&excess, "lift", text.data(), text.size()), 0);
  EXPECT_NE(std::string(text.data()).find("(lift)"), std::string::npos) << text.data();
}

TEST(CProperties, TimesOfAnotherClockAreRefusedAndNamed) {
  splinecast_producer_options options = CStream::recorded();
  options.clock = SPLINECAST_CLOCK_MONOTONIC;
  options.start.kind = SPLINECAST_HALT;
  const CStream c(options);
  const std::array<double, 2> values{1, 2};
  const std::int64_t wall = Time(std::chrono::system_clock::now().time_since_epoch()).count();
  const splinecast_waypoint waypoint = {
      wall, {values.data(), 2, 1}, SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR};
  EXPECT_EQ(splinecast_producer_append(c.producer, &waypoint), SPLINECAST_APPEND_TOO_FAR_AHEAD);
  EXPECT_STREQ(splinecast_append_text(SPLINECAST_APPEND_TOO_FAR_AHEAD), "too far ahead");
  std::array<char, 200> text{};
  EXPECT_GT(splinecast_time_message(waypoint.time, text.data(), text.size()), 0);
  EXPECT_NE(std::string(text.data()).find("like CLOCK_REALTIME"), std::string::npos) << text.data();
}

TEST(CProperties, ALiveStreamStartsFromAGivenState) {
  splinecast_producer_options options = CStream::recorded();
  options.clock = SPLINECAST_CLOCK_MONOTONIC;
  options.start.kind = SPLINECAST_HALT;
  const CStream c(options);
  const std::array<double, 2> values{1, 2};
  const splinecast_vector vector = {values.data(), 2, 1};
  const std::int64_t begin = splinecast_now() + 10'000'000'000;
  const splinecast_waypoint state = {begin, vector, vector, vector};
  EXPECT_EQ(splinecast_producer_start_from(c.producer, &state), SPLINECAST_APPEND_ACCEPTED);
  EXPECT_EQ(c.append(begin + 1'000'000'000, 3, 4), SPLINECAST_APPEND_ACCEPTED);
  EXPECT_EQ(splinecast_producer_start_from(c.producer, &state), SPLINECAST_APPEND_ALREADY_STARTED);
  EXPECT_EQ(splinecast_producer_finish(c.producer, nullptr), SPLINECAST_APPEND_ACCEPTED);
  EXPECT_EQ(c.append(begin + 2'000'000'000, 3, 4), SPLINECAST_APPEND_FINISHED);
}

TEST(CProperties, ASecondWriterIsBusyAndARemovedStreamIsGone) {
  testing::TestStream stream;
  const char* name = stream.name().c_str();
  splinecast_reader* reader = nullptr;
  EXPECT_EQ(splinecast_reader_create(name, 0, nullptr, &reader), SPLINECAST_ERROR_NO_STREAM);
  EXPECT_NE(std::string(splinecast_last_error()).find(name), std::string::npos);
  EXPECT_EQ(splinecast_remove(name), SPLINECAST_ERROR_NO_STREAM);
  splinecast_producer* producer = nullptr;
  ASSERT_EQ(splinecast_producer_create(name, nullptr, &producer), 0);
  splinecast_producer* second = producer;
  EXPECT_EQ(splinecast_producer_create(name, nullptr, &second), SPLINECAST_ERROR_BUSY);
  EXPECT_EQ(second, nullptr);
  EXPECT_EQ(splinecast_remove(name), SPLINECAST_ERROR_BUSY);
  EXPECT_EQ(splinecast_producer_withdraw(producer), 0);
  const double x = 0;
  const splinecast_waypoint waypoint = {0, {&x, 1, 0}, {}, {}};
  EXPECT_EQ(splinecast_producer_append(producer, &waypoint), SPLINECAST_ERROR_ARGUMENT);
  EXPECT_STREQ(splinecast_last_error(), "producer has been withdrawn");
  EXPECT_EQ(splinecast_producer_destroy(producer), 0);
}

TEST(CProperties, AnErrorBelongsToItsThread) {
  EXPECT_EQ(splinecast_remove(nullptr), SPLINECAST_ERROR_ARGUMENT);
  std::string other = "unset";
  std::thread([&] { other = splinecast_last_error(); }).join();
  EXPECT_EQ(other, "");
  EXPECT_STREQ(splinecast_last_error(), "stream is NULL");
}

TEST(CProperties, ALongMessageIsCutAtTheEndOfACharacter) {
  std::string name;
  for (int i = 0; i < 400; ++i) name += "é";
  for (const char* begin : {"", "x"}) {
    EXPECT_EQ(splinecast_remove((begin + name).c_str()), SPLINECAST_ERROR_ARGUMENT);
    const std::string message = splinecast_last_error();
    EXPECT_GE(message.size(), 510U);
    EXPECT_LE(message.size(), 511U);
    EXPECT_EQ(message.substr(message.size() - 2), "é");
  }
}

TEST(CProperties, TextsOfResultsAreThoseOfTheLibrary) {
  for (int i = 0; i < kAppendStatuses; ++i) {
    EXPECT_EQ(splinecast_append_text(i), to_string(static_cast<AppendStatus>(i)));
  }
  for (int i = 0; i < static_cast<int>(kSampleStatuses); ++i) {
    EXPECT_EQ(splinecast_sample_text(i), to_string(static_cast<SampleStatus>(i)));
    EXPECT_EQ(splinecast_has_values(i), has_values(static_cast<SampleStatus>(i)) ? 1 : 0);
  }
  for (int i = 0; i < static_cast<int>(kOutcomeKinds); ++i) {
    EXPECT_EQ(splinecast_outcome_text(i), to_string(static_cast<OutcomeKind>(i)));
  }
  for (int i = 0; i < static_cast<int>(kOutcomeWays); ++i) {
    EXPECT_EQ(splinecast_way_text(i), to_string(static_cast<OutcomeWay>(i)));
  }
  for (int i = 1; i < kRefusals; ++i) {
    EXPECT_EQ(splinecast_refusal_text(i), to_string(static_cast<Refusal>(i)));
  }
  for (const int number :
       {-1, 100, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    EXPECT_STREQ(splinecast_append_text(number), "unknown");
    EXPECT_STREQ(splinecast_sample_text(number), "unknown");
    EXPECT_STREQ(splinecast_outcome_text(number), "unknown");
    EXPECT_STREQ(splinecast_way_text(number), "unknown");
    EXPECT_STREQ(splinecast_refusal_text(number), "unknown");
    EXPECT_STREQ(splinecast_wait_text(number), "unknown");
    EXPECT_EQ(splinecast_has_values(number), 0);
  }
  EXPECT_STREQ(splinecast_refusal_text(0), "unknown");
  EXPECT_STREQ(splinecast_wait_text(SPLINECAST_WAIT_RETIRED), "retired");
  EXPECT_STREQ(splinecast_strerror(0), "no error");
  EXPECT_STREQ(splinecast_strerror(-99), "unknown error");
  for (int i = SPLINECAST_ERROR_INTERNAL; i < 0; ++i)
    EXPECT_STRNE(splinecast_strerror(i), "unknown error");
  EXPECT_EQ(std::string(splinecast_version()).find("0."), 0U);
}

TEST(CProperties, AppendAndSampleAllocateNothing) {
  const CStream c;
  c.send(20);
  splinecast_reader* reader = nullptr;
  splinecast_reader_options options = SPLINECAST_READER_OPTIONS_INIT;
  options.times = 10;
  ASSERT_EQ(splinecast_reader_create(c.name(), 0, &options, &reader), 0);
  std::array<double, 4> strided{1, 0, 2, 0};
  std::array<double, 8> values{};
  const splinecast_state state = {{values.data(), 2, 2}, {values.data() + 4, 2, 1}, {}, {}};
  const std::array<std::int64_t, 10> at{};
  const splinecast_times times = {at.data(), 10, 1};
  std::array<double, 10 * 3 * 8> block{};
  const splinecast_output_matrix out = {block.data(), 10, 8, 24, 2};
  std::array<uint8_t, 10> statuses{};
  const auto before = testing::allocations();
  int failures = 0;
  for (int i = 20; i < 200; ++i) {
    const splinecast_waypoint waypoint = {i * CStream::kStep, {strided.data(), 2, 2}, {}, {}};
    failures += splinecast_producer_append(c.producer, &waypoint) != 0 ? 1 : 0;
    failures += splinecast_reader_sample(reader, i, &state) < 0 ? 1 : 0;
    failures += splinecast_reader_sample_many(reader, &times, SPLINECAST_ALL_VALUES, &out,
                                              statuses.data(), 10, nullptr) != 1
                    ? 1
                    : 0;
  }
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(failures, 0) << splinecast_last_error();
  EXPECT_EQ(splinecast_reader_destroy(reader), 0);
}

}  // namespace
}  // namespace splinecast
