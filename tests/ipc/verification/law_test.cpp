#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <utility>

#include "core/laws/law_path.hpp"
#include "core/laws/rate_curve.hpp"
#include "ipc/ring/item_words.hpp"
#include "ipc/solve/law_planner.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/method.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Records of time laws whose first revisions were too late.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::MemoryStream;

core::WindowOptions law_window() {
  core::WindowOptions window{.interpolant = {.method = find_method("quintic")}};
  window.settle = window.interpolant.method->look_ahead;
  window.limits.acceleration = {1e12};
  return window;
}

/// A clock that is read late after the first time.
class LateClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override {
    return std::exchange(is_first_, false) ? Time{} : milliseconds(200);
  }

 private:
  mutable bool is_first_ = true;
};

/// A law that begins when the test says, and its record.
class RecordedLaw : public ::testing::Test, public LawPlanner {
 protected:
  RecordedLaw()
      : stream_(1, law_window(), 64, 64, {Time(1), kLatestTime / 2}, {},
                LiveOptions{.least_entry = Time(1)}),
        settled_(stream_.board.reader) {
    stream_.replace_producer();
    stream_.solver.plan_with(*this);
  }

  LawPlan plan(Time /*now*/, Time /*settled*/) noexcept override {
    if (const auto send = std::exchange(next_, nullptr)) send();
    return {};
  }

  WaypointRingWriter::Solved solved() {
    return {stream_.board.reader.consumed(), stream_.board.reader.look().settled_until};
  }

  void begin_next(Time start) {
    next_ = [this, start] {
      core::LawPath path({.time = start, .position = 0, .rate = 1, .slope = 0});
      path.add_begin();
      path.add_line();
      EXPECT_EQ(stream_.ring.writer.replace_from(start - Time(1), path.waypoints(), solved()),
                AppendStatus::accepted);
    };
  }

  void hold_next(Time begin) {
    next_ = [this, begin] {
      core::RateCurve curve(begin, {});
      curve.add(0, milliseconds(100));
      EXPECT_EQ(stream_.ring.writer.append_plan(curve.pieces(), 0, 1, solved()),
                AppendStatus::accepted);
    };
  }

  Verification verify() {
    ItemRecord items(1);
    items.note_items(stream_.ring.reader);
    items.note_refusals(stream_.board.reader, stream_.solver.summary().refused);
    settled_.look();
    return ipc::verify({.window = law_window(),
                        .kinds = {},
                        .items = items.items(),
                        .segments = settled_.segments(),
                        .summary = settled_.summary(),
                        .end = {}});
  }

  using ItemRecord = testing::ItemRecord;
  std::function<void()> next_;
  MemoryStream stream_;
  SettledSegments settled_;
};

TEST_F(RecordedLaw, VerifiesIfItBeganAgain) {
  begin_next(milliseconds(100));
  EXPECT_TRUE(stream_.solver.step(LateClock()).missed);
  begin_next(milliseconds(300));
  stream_.clock.time = milliseconds(250);
  stream_.solver.step(stream_.clock);
  EXPECT_EQ(stream_.solver.summary().withdrawn, 3U);
  hold_next(milliseconds(900));
  stream_.clock.time = milliseconds(800);
  stream_.solver.step(stream_.clock);
  stream_.clock.time = milliseconds(2000);
  stream_.solver.step(stream_.clock);
  const Verification found = verify();
  EXPECT_FALSE(found.first) << found.first->what << ": " << found.first->published;
  EXPECT_GE(found.equal, 2U);
}

}  // namespace
}  // namespace splinecast::ipc
