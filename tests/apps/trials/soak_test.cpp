#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/process/child.hpp"
#include "apps/process/use.hpp"
#include "apps/soak/roles.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/streams.hpp"
#include "tests/apps/streams/life.hpp"

/// Many streams in few real processes.
namespace splinecast::apps {
namespace {

TEST_F(Life, OneProcessSolvesTheStreamsOfAPatternAndASecondTakesOverWhenItIsKilled) {
  const std::string pattern = name() + "*";
  const TestStream another;
  Process first({"solve", pattern, "--capacity", "4096"});
  Producer producer(name(), {.dimensions = 1, .clock = StreamClock::recorded, .start = {}});
  first.await_message("'" + name() + "': solving");
  Process second({"solve", pattern, another.name()});
  second.await_message("'" + name() + "': solved by another process");
  ASSERT_TRUE(producer.wait_for_solver(Time(1)));
  const std::vector<double> x{1};
  ASSERT_EQ(producer.append({.time = Time(0), .position = x}), AppendStatus::accepted);
  EXPECT_TRUE(producer.wait_until_consumed(testing::kPatience));
  first.signal(SIGKILL);
  second.await_message("'" + name() + "': taken over");
  ASSERT_EQ(producer.append({.time = Time(10'000'000), .position = x}), AppendStatus::accepted);
  EXPECT_TRUE(producer.wait_until_consumed(testing::kPatience));
  second.signal(SIGINT);
  EXPECT_EQ(second.wait().code, 0);
}

TEST(Solve, AnInvalidCapacityIsWrongUsageForAPatternToo) {
  EXPECT_EQ(testing::run({"solve", "unused.*", "--capacity", "3"}).code, 2);
}

/// Makes an AddressSanitizer in the program release freed memory immediately. By default it keeps
/// freed memory, to detect its use, and the process grows.
class Soak : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "the memory of ThreadSanitizer grows";
#endif
  }
  Soak() { setenv("ASAN_OPTIONS", "quarantine_size_mb=0:thread_local_quarantine_size_kb=0", 1); }
  ~Soak() override { unsetenv("ASAN_OPTIONS"); }
};

/// Duration of the streams in seconds; SPLINECAST_SOAK_SECONDS overrides it.
std::string soak_seconds() {
  const char* const asked = std::getenv("SPLINECAST_SOAK_SECONDS");
  return asked == nullptr ? "9" : asked;
}

TEST_F(Soak, AHundredStreamsLoseNothingAndNothingGrowsWhileProducersAreKilled) {
  const testing::Ended ended = testing::run({"soak", "--seconds", soak_seconds(), "--json"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const auto found = nlohmann::json::parse(ended.out);
  EXPECT_EQ(found["streams"], 100);
  EXPECT_EQ(found["lossy_streams"], 0);
  EXPECT_EQ(found["unfinished_streams"], 0);
  EXPECT_GE(found["producer_kills"].get<int>(), 4);
  const auto& counted = found["counters"];
  EXPECT_GT(counted["interpolated"].get<int>(), 0);
  EXPECT_EQ(found["appended"].get<int>(),
            counted["interpolated"].get<int>() + counted["passed_over"].get<int>() +
                counted["refused"].get<int>() + counted["withdrawn"].get<int>() +
                counted["controls"].get<int>());
  for (const auto& reader : found["read"]) {
    EXPECT_EQ(reader["changed"], 0);
    EXPECT_GT(reader["joins"].get<int>(), 0);
  }
  for (const char* const role : {"solver", "producers", "readers"}) {
    EXPECT_FALSE(found[role]["grown"].get<bool>()) << found[role];
    EXPECT_GT(found[role]["descriptors"][1].get<int>(), 0);
  }
}

TEST_F(Soak, ShowsATableAndRemovesItsStreams) {
  Process soaking({"soak", "--streams", "3", "--seconds", "4", "--readers", "1"});
  const std::string mine = "soak." + std::to_string(soaking.pid()) + ".";
  const testing::Ended ended = soaking.wait();
  EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
  EXPECT_NE(ended.out.find("consumed"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("streams that lost one: 0"), std::string::npos) << ended.out;
  EXPECT_TRUE(std::ranges::none_of(
      stream_names(), [&](const std::string& stream) { return stream.starts_with(mine); }));
}

TEST_F(Soak, IsNotJudgedIfItIsInterrupted) {
  for (const char* const form : {"--json", "--readers=1"}) {
    Process soaking({"soak", "--streams", "3", "--seconds", "1000", form});
    const std::string stream = "soak." + std::to_string(soaking.pid()) + ".2";
    ASSERT_TRUE(await([&] {
      const auto now = testing::info(stream);
      return now.is_object() && now["solver"].is_object() && now["solver"]["interpolated"] > 10;
    }));
    soaking.signal(SIGTERM);
    const testing::Ended ended = soaking.wait();
    EXPECT_EQ(ended.code, 130) << ended.err;
    if (std::string(form) == "--json") {
      const auto found = nlohmann::json::parse(ended.out, nullptr, false);
      ASSERT_TRUE(found.is_object()) << ended.out << ended.err;
      EXPECT_FALSE(found["judged"].get<bool>());
      EXPECT_TRUE(found["sound"].is_null());
    } else {
      EXPECT_NE(ended.out.find("not judged"), std::string::npos) << ended.out;
    }
  }
}

TEST_F(Life, AProducerOfSoakContinuesAfterAnUnderrun) {
  constexpr ipc::Word kMore = 20;
  Process solver(solve());
  const Child producer(
      [this] { return run_soak_producers({name()}, 100, MonotonicClock().now()); });
  ASSERT_TRUE(await([this] { return field("solver", "interpolated") > kMore; }));
  producer.signal(SIGSTOP);
  ASSERT_TRUE(await([this] { return field("solver", "underruns") > 0; }));
  const ipc::Word before = field("solver", "interpolated");
  producer.signal(SIGCONT);
  EXPECT_TRUE(await([&] { return field("solver", "interpolated") > before + kMore; }));
}

TEST(Flatness, ReportsGrowthOfTheSecondHalfBeyondTheToleranceButNotTheWarmUp) {
  Flatness flat(10);
  for (const std::size_t value : {1000U, 1000U, 100U, 90U, 80U, 110U, 70U}) flat.add(value);
  EXPECT_FALSE(flat.has_grown());
  EXPECT_EQ(flat.first(), 1000U);  // of 7 values, only the first is warm-up
  flat.add(100);
  EXPECT_EQ(flat.first(), 100U);
  EXPECT_EQ(flat.second(), 110U);
  EXPECT_FALSE(flat.has_grown());
  flat.add(111);
  EXPECT_EQ(flat.second(), 111U);
  EXPECT_TRUE(flat.has_grown());
}

TEST(Flatness, OfNoValuesHasNotGrown) {
  const Flatness flat(0);
  EXPECT_EQ(flat.second(), 0U);
  EXPECT_FALSE(flat.has_grown());
}

TEST(ProcessUse, CountsNewDescriptorsAndMemory) {
  const auto before = process_use(getpid());
  ASSERT_TRUE(before);
  constexpr std::size_t kBytes = std::size_t{64} << 20U;
  const std::vector<char> memory(kBytes, 1);
  const int taken = dup(STDERR_FILENO);
  const auto after = process_use(getpid());
  close(taken);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->descriptors, before->descriptors + 1);
  for (const auto bytes :
       {&ProcessUse::mapped_bytes, &ProcessUse::resident_bytes, &ProcessUse::private_bytes}) {
    EXPECT_GE((*after).*bytes, (*before).*bytes + kBytes / 2) << memory.back();
  }
}

TEST(ProcessUse, ReportsTheCpuTimeOfTheProcess) {
  constexpr pid_t kNoProcess = 4'194'305;  // above the largest pid on Linux

  const Time before = cpu_time(getpid());
  EXPECT_TRUE(
      testing::await([&] { return cpu_time(getpid()) - before >= std::chrono::milliseconds(20); }));
  EXPECT_FALSE(process_use(-1));
  EXPECT_EQ(cpu_time(kNoProcess), Time::zero());
}

}  // namespace
}  // namespace splinecast::apps
