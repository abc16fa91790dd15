#include <csignal>
#include <filesystem>
#include <string>

#include "apps/rate/report.hpp"
#include "splinecast/producer.hpp"
#include "tests/apps/rate/rate.hpp"

/// `rate` with real processes: several commanders, their death, removal.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;

/// Number of files in shared memory whose name contains `text`.
std::ptrdiff_t files_with(const std::string& text) {
  return std::ranges::count_if(std::filesystem::directory_iterator("/dev/shm"),
                               [&](const std::filesystem::directory_entry& file) {
                                 return file.path().string().find(text) != std::string::npos;
                               });
}

TEST_F(Rate, ShowsTheRateAndWhoRequestsIt) {
  Process solver({"solve", law()});
  ASSERT_EQ(rate({"0.5", "--ramp", "0.01"}).code, 0);
  ASSERT_TRUE(await_rate(0.5));
  const Ended text = rate();
  EXPECT_EQ(text.code, 0);
  EXPECT_NE(text.out.find("': rate 0.5, slope 0 /s, 1 at most; lag "), std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("operator         rate 0.5, ramp 0.01 s\n"), std::string::npos)
      << text.out;
  const auto json = shown();
  EXPECT_EQ(json["law"], law());
  EXPECT_EQ(json["solved"], true);
  EXPECT_EQ(json["rate"], 0.5);
  EXPECT_EQ(json["largest_rate"], 1.0);
  EXPECT_GE(json["lag_s"], 0);
  EXPECT_EQ(json["followers"].size(), 0U);
  ASSERT_EQ(json["commanders"].size(), 1U);
  EXPECT_EQ(json["commanders"][0], (nlohmann::json{{"name", "operator"},
                                                   {"rate", 0.5},
                                                   {"ramp_s", 0.01},
                                                   {"dead_man_s", 0.0},
                                                   {"dead_man_expired", false}}));
}

TEST(LawReport, ShowsNoRoundingErrorsOfTheCurve) {
  const LawReport held{.law = "cell",
                       .is_solved = true,
                       .rate = 7e-34,
                       .slope = -3e-17,
                       .commanders = {},
                       .followers = {}};
  EXPECT_NE(in_words(held).find("rate 0, slope 0 /s"), std::string::npos) << in_words(held);
  EXPECT_EQ(to_json(held)["rate"], 0.0);
  EXPECT_EQ(to_json(held)["slope_per_s"], 0.0);
  const LawReport slow{.law = "cell",
                       .is_solved = true,
                       .rate = 1e-8,
                       .slope = -2e-9,
                       .commanders = {},
                       .followers = {}};
  EXPECT_EQ(to_json(slow)["rate"], 1e-8);
  EXPECT_EQ(to_json(slow)["slope_per_s"], -2e-9);
}

TEST_F(Rate, ARequestBeforeThereIsASolverIsTheRateAtWhichTheLawBegins) {
  const Ended early = rate({"0.25", "--wait", "0"});
  EXPECT_EQ(early.code, 0);
  EXPECT_NE(early.err.find("waiting for a solver"), std::string::npos) << early.err;
  EXPECT_EQ(shown()["solved"], false);
  Process solver({"solve", law()});
  ASSERT_TRUE(await_rate(0.25));
}

TEST_F(Rate, ARequestThatNoSolverTakesEndsWithACodeOfItsOwn) {
  const Ended early = rate({"0.25", "--wait", "0.02"});
  EXPECT_EQ(early.code, 4);
  EXPECT_NE(early.err.find("request 1 of 'operator' is not in force after 0.02 s; it remains"),
            std::string::npos)
      << early.err;
  Process solver({"solve", law()});
  ASSERT_TRUE(await_rate(0.25));
  EXPECT_EQ(rate({"0.5", "--ramp", "0.01"}).code, 0);
}

TEST_F(Rate, ASeventeenthCommanderIsRefusedWithTheNamesOfTheOthers) {
  Process solver({"solve", law()});
  for (int i = 0; i < 16; ++i) {
    ASSERT_EQ(rate({"1", "--as", "c" + std::to_string(i)}).code, 0) << i;
  }
  const Ended more = rate({"0", "--as", "more"});
  EXPECT_EQ(more.code, 1);
  EXPECT_NE(more.err.find("16 commanders"), std::string::npos) << more.err;
  EXPECT_NE(more.err.find("c0, c1, c2"), std::string::npos) << more.err;
  ASSERT_EQ(rate({"--release", "--as", "c7"}).code, 0);
  ASSERT_TRUE(testing::await([&] {
    return rate({"0", "--as", "more", "--ramp", "0.01"}).code == 0;
  }));
  EXPECT_TRUE(await_rate(0));
}

TEST_F(Rate, TheLeastRequestOfLivingAndKilledProcessesWins) {
  Process solver({"solve", law()});
  Process slow = start_rate({"0.4", "--ramp", "0.01", "--as", "slow", "--dead-man", "600"});
  Process fast = start_rate({"0.8", "--ramp", "0.01", "--as", "fast", "--dead-man", "600"});
  ASSERT_TRUE(await_rate(0.4));
  ASSERT_TRUE(testing::await([&] { return commander("fast")["rate"] == 0.8; }));
  Process stop = start_rate({"0", "--ramp", "0.01", "--as", "estop", "--dead-man", "600"});
  ASSERT_TRUE(await_rate(0));
  stop.signal(SIGKILL);
  EXPECT_EQ(stop.wait().signal, SIGKILL);
  // The hold of the dead process stays in force, also when the others request again.
  fast.signal(SIGTERM);
  EXPECT_EQ(fast.wait().code, 0);
  ASSERT_EQ(rate({"1", "--ramp", "0.01", "--as", "fast"}).code, 0);
  ASSERT_EQ(rate({"1", "--ramp", "0.01"}).code, 0);
  EXPECT_EQ(commander("estop")["rate"], 0);
  for (int i = 0; i < 1000; ++i) ASSERT_NEAR(law_rate(), 0, kRounding);
  ASSERT_EQ(rate({"--release", "--ramp", "0.01", "--as", "estop"}).code, 0);
  ASSERT_TRUE(await_rate(0.4));
  EXPECT_TRUE(commander("estop")["rate"].is_null());
}

TEST_F(Rate, ADeadManHoldsTheLawWhenItsProcessIsKilled) {
  Process solver({"solve", law()});
  Process pendant = start_rate({"1", "--ramp", "0.01", "--as", "pendant", "--dead-man", "1"});
  ASSERT_TRUE(await_rate(1));
  pendant.signal(SIGKILL);
  (void)pendant.wait();
  ASSERT_TRUE(await_rate(0));
  EXPECT_EQ(commander("pendant")["dead_man_expired"], true);
  EXPECT_NE(rate().out.find("expired, holds"), std::string::npos);
  // A commander of the same name takes over.
  ASSERT_EQ(rate({"0.5", "--ramp", "0.01", "--as", "pendant"}).code, 0);
  ASSERT_TRUE(await_rate(0.5));
}

TEST_F(Rate, ALawIsRemovedWithItsCommandersWhenNoneLives) {
  Process solver({"solve", law()});
  Process panel = start_rate({"1", "--as", "panel", "--dead-man", "600"});
  ASSERT_EQ(rate({"1"}).code, 0);
  ASSERT_TRUE(await_rate(1));
  ASSERT_TRUE(testing::await([&] { return commander("panel")["rate"] == 1; }));
  solver.signal(SIGTERM);
  (void)solver.wait();
  const Ended busy = testing::run({"rm", law()});
  EXPECT_EQ(busy.code, 1);
  EXPECT_NE(busy.err.find("living commander 'panel'"), std::string::npos) << busy.err;
  panel.signal(SIGTERM);
  (void)panel.wait();
  const Ended removed = testing::run({"rm", "--now", law()});
  EXPECT_EQ(removed.code, 0) << removed.err;
  EXPECT_EQ(files_with(law()), 0);
  EXPECT_EQ(rate().code, 4);
}

TEST_F(Rate, ARateAboveTheLargestIsWrongUsage) {
  Process solver({"solve", law()});
  ASSERT_EQ(rate({"1", "--ramp", "0.01"}).code, 0);
  ASSERT_TRUE(await_rate(1));
  const Ended refused = rate({"1.5"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("is above the largest rate of '" + law() + "', 1: 1.5"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(commander("operator")["rate"], 1);
}

TEST_F(Rate, OfAStreamWithoutALawSaysHowToGetOne) {
  const Producer arm(law(), {.dimensions = 1});
  const Ended refused = rate({"0"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("is a stream without a time law"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("splinecast stop " + law()), std::string::npos) << refused.err;
  EXPECT_EQ(rate().code, 2);
}

TEST_F(Rate, RefusesWhatCannotBeRequested) {
  EXPECT_EQ(rate().code, 4);
  EXPECT_EQ(rate({"101"}).code, 2);
  EXPECT_EQ(rate({"-0.1"}).code, 2);
  EXPECT_EQ(rate({"nan"}).code, 2);
  EXPECT_EQ(rate({"1", "--ramp", "0"}).code, 2);
  EXPECT_EQ(rate({"1", "--ramp", "3601"}).code, 2);
  EXPECT_EQ(rate({"1", "--dead-man", "0"}).code, 2);
  EXPECT_EQ(rate({"1", "--release"}).code, 2);
  EXPECT_EQ(rate({"1", "--as", "a@b"}).code, 2);
  EXPECT_EQ(testing::run({"rate", "a@b", "1"}).code, 2);
  EXPECT_EQ(files_with(law()), 0);
  Process holder = start_rate({"1", "--dead-man", "600"});
  ASSERT_TRUE(testing::await([&] { return commander("operator")["rate"] == 1; }));
  const Ended busy = rate({"1"});
  EXPECT_EQ(busy.code, 1);
  EXPECT_NE(busy.err.find("has a living"), std::string::npos) << busy.err;
}

}  // namespace
}  // namespace splinecast::apps
