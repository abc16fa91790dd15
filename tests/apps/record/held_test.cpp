#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "tests/apps/record/recorded.hpp"

/// `record` beside a stream that a time law holds, with solvers in processes of their own.
namespace splinecast::testing {
namespace {

using std::chrono::milliseconds;

class RecordHeld : public RecorderTest {
 protected:
  RecordHeld() {
    operator_.set_rate(1, milliseconds(10));
    const Reader law(law_.name(), kPatience);
    producer_.emplace(arm_.name(), ProducerOptions{.clock = StreamClock::law, .law = law_.name()});
    reader_.emplace(arm_.name(), kPatience);
  }

  /// Appends a sine from 300 ms after now on.
  void append(int count) {
    Time t = producer_->now() + milliseconds(300);
    for (int i = 0; i < count; ++i, t += milliseconds(20)) {
      const std::array x{std::sin(4 * to_seconds(t))};
      ASSERT_EQ(producer_->append({.time = t, .position = x}), AppendStatus::accepted);
    }
    end_ = t;
  }
  [[nodiscard]] bool await_stream_time(Time t) {
    return await([&] { return producer_->now() >= t; });
  }
  [[nodiscard]] bool await_rate(double rate) {
    State state(1);
    return await([&] {
      return has_values(reader_->preview(clock_.now(), state)) && reader_->rate().rate == rate;
    });
  }

  TestFolder folder_;
  TestStream law_;
  TestStream arm_;
  MonotonicClock clock_;
  RateCommander operator_{law_.name(), "operator"};
  Process solver_{{"solve", law_.name(), arm_.name(), "--quiet"}};
  std::optional<Producer> producer_;
  std::optional<Reader> reader_;
  Time end_{};
};

TEST_F(RecordHeld, StopsInHoldsVerifyBitForBit) {
  const std::string path = folder_.path("run.mcap");
  Process recorder = start_recorder({arm_.name(), law_.name(), "-o", path});
  int from_rest = 0;
  for (int i = 0; i < 20 && (i < 3 || from_rest == 0); ++i) {
    append(100);
    ASSERT_TRUE(await_stream_time(end_ - milliseconds(1500)));
    operator_.hold(milliseconds(20));
    ASSERT_TRUE(await_rate(0));
    const Time held = producer_->now();
    // The recorder looks several times while more is settled than the machine has reached.
    const Time until = clock_.now() + milliseconds(100);
    ASSERT_TRUE(await([&] { return clock_.now() > until; }));
    ASSERT_EQ(producer_->replace_from(Time::min(), {}), AppendStatus::accepted);
    ASSERT_TRUE(await([&] { return producer_->replacement_begin().has_value(); }));
    const auto begin = producer_->replacement_begin();
    if (begin->from_rest) {
      ++from_rest;
      EXPECT_EQ(begin->begin, held + Time(1));
    }
    operator_.set_rate(1, milliseconds(20));
    ASSERT_TRUE(await_rate(1));
  }
  EXPECT_GT(from_rest, 0);
  ASSERT_EQ(producer_->finish({.kind = ConditionKind::halt, .value = {}}), AppendStatus::accepted);
  ASSERT_TRUE(await([&] { return reader_->progress()->is_finished; }));
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const Verified found = verify(path);
  EXPECT_EQ(found.code, 0) << found.err << found.json.dump(1);
  for (const std::string& stream : {arm_.name(), law_.name()}) {
    EXPECT_GT(found.stream(stream)["equal"], 0);
    EXPECT_TRUE(found.stream(stream)["difference"].is_null()) << found.json.dump(1);
  }
}

}  // namespace
}  // namespace splinecast::testing
