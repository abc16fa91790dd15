#include "apps/record/output/dump_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

/// When dumps begin and end, for random events.
namespace splinecast::apps::record {
namespace {

using std::chrono::milliseconds;

struct Dump {
  std::string why;
  Time began;
  Time ended = Time::max();
};

/// A schedule, and the dumps that it made.
struct Dumps {
  Dumps(Time last, Time after) : schedule(last, after) {}

  void tick(Time now) {
    if (!schedule.is_due(now)) return;
    all.back().ended = now;
    if (const auto next = schedule.close(now)) all.push_back({*next, now});
  }
  void event(Time now) {
    ++events;
    if (schedule.take_event("event", now)) all.push_back({"event", now});
  }
  void trigger(Time now) {
    if (schedule.is_open()) all.back().ended = now;
    schedule.take_trigger(now);
    all.push_back({"trigger", now});
  }
  /// Whether dumps have all from `from` to `until`, where each has `last` before it.
  bool have(Time from, Time until, Time last) const {
    for (const Dump& dump : all) {
      if (dump.began - last <= from && from <= dump.ended) from = dump.ended;
    }
    return from >= until;
  }

  DumpSchedule schedule;
  std::vector<Dump> all{};
  std::uint64_t events = 0;
};

TEST(DumpSchedule, EachEventIsInADumpWithWhatIsBeforeAndAfterIt) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    const Time last = milliseconds(1 + random() % 5000);
    const Time after = milliseconds(random() % 3 == 0 ? 0 : random() % 8000);
    const std::uint64_t rarity = 1 + random() % 3000;
    Dumps dumps(last, after);
    std::vector<Time> events;
    for (Time now(0); now < std::chrono::seconds(40); now += milliseconds(1)) {
      if (random() % rarity == 0) {
        dumps.event(now);
        events.push_back(now);
      }
      if (now.count() % 10'000'000 == 0) dumps.tick(now);
    }
    std::size_t at = 0;
    for (const Time event : events) {
      while (at < dumps.all.size() && dumps.all[at].ended < event) ++at;
      ASSERT_LT(at, dumps.all.size()) << round;
      EXPECT_LE(dumps.all[at].began, event) << round;  // so it has `last` before the event
      EXPECT_TRUE(dumps.have(event, event + after, last)) << round << " " << event.count();
    }
    const std::int64_t most = std::chrono::seconds(40) / last + 2;
    EXPECT_LE(static_cast<std::int64_t>(dumps.all.size()), most) << round;
    EXPECT_GE(dumps.schedule.further_events() + dumps.all.size(), dumps.events) << round;
  }
}

TEST(DumpSchedule, RepeatedEventsAreInDumpsOfABoundedLength) {
  constexpr Time kLast = milliseconds(1000);
  constexpr Time kAfter = milliseconds(300);
  Dumps dumps(kLast, kAfter);
  for (Time now(0); now < std::chrono::seconds(20); now += milliseconds(5)) {
    dumps.event(now);
    dumps.tick(now);
  }
  EXPECT_GE(dumps.all.size(), 15U);
  dumps.all.pop_back();  // it is open
  for (const Dump& dump : dumps.all) EXPECT_LE(dump.ended - dump.began, kLast + kAfter);
}

TEST(DumpSchedule, AnEventAfterAPauseIsAShortDump) {
  Dumps dumps(milliseconds(1000), milliseconds(10));
  for (const int at : {0, 1200, 2500}) {
    dumps.event(milliseconds(at));
    dumps.tick(milliseconds(at + 9));
    EXPECT_TRUE(dumps.schedule.is_open()) << at;
    dumps.tick(milliseconds(at + 10));
    EXPECT_FALSE(dumps.schedule.is_open()) << at;
  }
  EXPECT_EQ(dumps.all.size(), 3U);
  EXPECT_EQ(dumps.schedule.further_events(), 0U);
}

TEST(DumpSchedule, ATriggerBeginsADumpAtOnceThatTakesOverTheEndOfTheOpenOne) {
  Dumps dumps(milliseconds(1000), milliseconds(100));
  dumps.event(milliseconds(0));
  dumps.tick(milliseconds(100));
  dumps.event(milliseconds(200));  // soon: until 1200 ms
  dumps.trigger(milliseconds(300));
  dumps.tick(milliseconds(1199));
  EXPECT_TRUE(dumps.schedule.is_open());
  dumps.trigger(milliseconds(1199));
  dumps.tick(milliseconds(1299));
  EXPECT_FALSE(dumps.schedule.is_open());
  dumps.trigger(milliseconds(1300));
  dumps.tick(milliseconds(1400));
  EXPECT_FALSE(dumps.schedule.is_open());
  ASSERT_EQ(dumps.all.size(), 5U);
  EXPECT_EQ(dumps.all[2].why, "trigger");
}

}  // namespace
}  // namespace splinecast::apps::record
