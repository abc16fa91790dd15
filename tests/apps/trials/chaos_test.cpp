#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/clock.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

/// Real processes on the real clock, killed with SIGKILL and paused with SIGSTOP.
TEST(Chaos, NoReaderNoticesThatWritersAreKilledAndStarved) {
#ifdef __SANITIZE_THREAD__
  constexpr int kLeast = 10;  // everything is about ten times slower
#else
  constexpr int kLeast = 100;
#endif
  const testing::Ended ended = testing::run({"demo", "--chaos", "--seconds", "8", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const auto found = nlohmann::json::parse(ended.out);
  EXPECT_TRUE(found["judged"].get<bool>());
  EXPECT_TRUE(found["sound"].get<bool>());
  EXPECT_EQ(found["lost"], 0);
  EXPECT_GT(found["interpolated"].get<int>(), kLeast);
  EXPECT_GE(found["solver"]["kills"].get<int>() + found["producer"]["kills"].get<int>() +
                found["pauses"].get<int>(),
            1);
  ASSERT_EQ(found["readers"].size(), 3U);
  for (const auto& reader : found["readers"]) {
    EXPECT_EQ(reader["changed"], 0);
    EXPECT_GT(reader["joins"].get<int>(), kLeast);
    // The limit is ten times the peak of the motion; 0.01 is for rounding.
    EXPECT_LT(reader["acceleration"].get<double>(),
              10.01 * found["peak_acceleration_of_the_motion"].get<double>());
  }
}

TEST(Chaos, IsNotJudgedIfItIsInterruptedAndNoReaderSpins) {
  constexpr int kMoving = 200;  // waypoints until the motion has begun, which takes time to stop
  const MonotonicClock clock;
  const Time begin = clock.now();
  testing::Process demo({"demo", "--chaos", "--seconds", "1000", "--json"});
  const std::string stream = "demo." + std::to_string(demo.pid());
  ASSERT_TRUE(testing::await([&] {
    const auto now = testing::info(stream);
    return now.is_object() && now["solver"].is_object() && now["solver"]["interpolated"] > kMoving;
  }));
  demo.signal(SIGINT);
  const testing::Ended ended = demo.wait();
  const auto took_ms = (clock.now() - begin).count() / 1'000'000;
  EXPECT_EQ(ended.code, 130) << ended.err;
  const auto found = nlohmann::json::parse(ended.out, nullptr, false);
  ASSERT_TRUE(found.is_object()) << ended.out << ended.err;
  EXPECT_FALSE(found["judged"].get<bool>());
  EXPECT_TRUE(found["sound"].is_null());
  for (const auto& reader : found["readers"]) EXPECT_LE(reader["samples"], took_ms + 100);
}

}  // namespace
}  // namespace splinecast::apps
