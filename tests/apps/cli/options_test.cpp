#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

/// A rate, time or count that is out of range is wrong usage. It never causes an overflow, an
/// endless loop or a lack of memory.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::TestFolder;

/// Arguments, and texts that the error must contain: the value and the range.
struct Wrong {
  std::vector<std::string> arguments;
  std::vector<std::string> named;
};

void expect_refused(const std::vector<Wrong>& cases) {
  for (const Wrong& one : cases) {
    std::string line;
    for (const std::string& argument : one.arguments) line += " " + argument;
    const Ended ended = testing::run(one.arguments);
    EXPECT_EQ(ended.code, 2) << line << ": " << ended.err;
    for (const std::string& text : one.named) {
      EXPECT_NE(ended.err.find(text), std::string::npos) << line << ": " << ended.err;
    }
  }
}

constexpr const char* kHuge = "18446744073709551615";

TEST(Options, OldValuesAreAcceptedAndTheNewOnesAreNamed) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n2,3\n3,2\n4,4\n");
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases{
      {{"--start", "rest"}, {"--start", "clamped"}},
      {{"--end", "rest"}, {"--end", "clamped"}},
      {{"--online", "--tail", "rest"}, {"--online", "--tail", "clamped"}},
      {{"--kind", "x:wrap:3"}, {"--kind", "x:periodic:3"}}};
  for (const auto& [old, present] : cases) {
    const auto fit = [&](const std::vector<std::string>& options) {
      std::vector<std::string> arguments{"fit", file, "--dt", "0.1"};
      arguments.insert(arguments.end(), options.begin(), options.end());
      return testing::run(arguments);
    };
    const Ended before = fit(old);
    const Ended now = fit(present);
    EXPECT_EQ(before.code, 0) << before.err;
    EXPECT_EQ(before.out, now.out);
    EXPECT_EQ(now.err, "");
    EXPECT_NE(before.err.find("is now '" + present.back()), std::string::npos) << before.err;
  }
}

TEST(Options, ASampleWhoseTimeWouldOverflowIsWrongUsage) {
  const std::vector<std::string> sample{"sample", "no.such.stream", "--wait", "0"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), sample.begin(), sample.end());
    return more;
  };
  expect_refused({
      {with({"--rate", "1e-6", "--count", "10000"}),
       {"10000 samples at 1e-06 Hz take 9999000000 s", "the maximum is 3162240000 s"}},
      {with({"--rate", "1e-7", "--count", "1"}),
       {"'1e-7' is not a number from 1e-06 to 1000000000"}},
      {with({"--rate", "nan", "--count", "1"}), {"'nan' is not a number from 1e-06"}},
      {with({"--rate", "inf", "--count", "1"}), {"'inf' is not a number from 1e-06"}},
      {with({"--rate", "1", "--count", "0"}), {"'0' is not an integer from 1 to"}},
      {with({"--rate", "1e9", "--count", kHuge}), {kHuge, "is not an integer from 1 to"}},
      {{"sample", "no.such.stream", "--rate", "1", "--count", "1", "--wait", "1e10"},
       {"'1e10' is not a time from 0 to"}},
  });
  // The latest possible time.
  EXPECT_EQ(testing::run(with({"--rate", "1e-6", "--count", "3163"})).code, 4);
}

TEST(Options, SoakAndDemoSizesOutOfRangeAreWrongUsage) {
  expect_refused({
      {{"soak", "--streams", "1000000000"}, {"'1000000000' is not an integer from 1 to 10000"}},
      {{"soak", "--streams", "0"}, {"'0' is not an integer from 1"}},
      {{"soak", "--seconds", "0"}, {"'0' is not a time from 1 to"}},
      {{"soak", "--seconds", "-1"}, {"'-1' is not a time from 1 to"}},
      {{"soak", "--seconds", "1e12"}, {"'1e12' is not a time from 1 to 3162240000 s"}},
      {{"soak", "--readers", "1000000000"}, {"is not an integer from 1 to 64"}},
      {{"soak", "--rate", "nan"}, {"'nan' is not a number from 1 to 1000"}},
      {{"soak", "--rate", "1e9"}, {"'1e9' is not a number from 1 to 1000"}},
      {{"demo", "--seconds", "0"}, {"'0' is not a time from 0.1 to"}},
      {{"demo", "--seconds", "1e9"}, {"'1e9' is not a time from 0.1 to 86400 s"}},
      {{"demo", "--seconds", "3601"}, {"'3601' is not a time from 0.1 to 3600 s"}},
      {{"demo", "--chaos", "--seconds", "86401"}, {"'86401' is not a time from 0.1 to 86400 s"}},
  });
}

TEST(Options, OfSolveAndLatencyNameTheirRanges) {
  expect_refused({
      {{"solve", "x", "--sweep", "0"}, {"'0' is not a time from 1e-06 to 1000 ms"}},
      {{"solve", "x", "--sweep", "1001"}, {"'1001' is not a time from 1e-06 to 1000 ms"}},
      {{"solve", "x", "--freeze-ahead", "1e300"},
       {"'1e300' is not a number in the range 1 ns to 1 min"}},
      {{"solve", "x", "--freeze-ahead", "60000.1"}, {"'60000.1' is not a number in the range"}},
      {{"solve", "x", "--capacity", kHuge}, {kHuge}},
      {{"solve", "x", "--capacity", "4194305"}, {"'4194305' is not an integer from 2 to 4194304"}},
      {{"solve", "x", "--stop-time", "0"}, {"'0' is not a number in the range above 0"}},
      {{"solve", "x", "--history", "-1"}, {"'-1' is not a number in the range 0 to 24 h"}},
      {{"latency", "--rate", "nan"}, {"'nan' is not a number from 1 to 100000"}},
      {{"latency", "--duration", "1e6"}, {"'1e6' is not a time from 1e-09 to 14400 s"}},
      {{"latency", "--warmup", "1e6"}, {"'1e6' is not a time from 0 to 14400 s"}},
      {{"latency", "--rate", "1", "--duration", "14400", "--readers", "64"},
       {"bytes; the maximum is"}},
      {{"latency", "--lead", "1e9"}, {"'1e9' is not a time from 0 to 60000 ms"}},
      {{"latency", "--deadline", "1e300"}, {"'1e300' is not a time from 1e-06 to"}},
      {{"latency", "compare", "a", "b", "--threshold", "nan"}, {"'nan' is not a number from 0"}},
      {{"latency", "compare", "a", "b", "--least", "inf"}, {"'inf' is not a number from 0"}},
  });
}

TEST(Options, OfVerbsThatReadAFileNameTheirRanges) {
  const TestFolder folder;
  const std::string file = folder.write("a.csv", "t,x\n0,0\n1e6,1\n4e6,2\n");
  const auto replay = [&](std::vector<std::string> more) {
    const std::vector<std::string> first{"replay", file, "--stream", "no.such.stream",
                                         "--wait", "0",  "--clock",  "recorded",
                                         "--rate", "max"};
    more.insert(more.begin(), first.begin(), first.end());
    return more;
  };
  const std::string curve = folder.write("p.csv", "duration,x^0\n1,0\n");
  expect_refused({
      {replay({"--loop", "1000", "--max-interval", "2e9"}),
       {"--loop 1000 takes", "the maximum is 3162240000 s"}},
      {replay({"--loop", "10000000000"}), {"is not an integer from 1 to 1000000000"}},
      {replay({"--capacity", kHuge, "--max-interval", "3e9"}), {kHuge}},
      {replay({"--capacity", "16777217", "--max-interval", "3e9"}),
       {"'16777217' is not an integer from 2 to 16777216"}},
      {replay({"--lead", "1e14"}), {"'1e14' is not a time from 0 to"}},
      {replay({"--min-interval", "0"}), {"'0' is not a number in the range 1 ns or more"}},
      {replay({"--max-interval", "1e10"}),
       {"'1e10' is not a number in the range min_interval or more, below 2⁶¹ ns"}},
      {{"replay", file, "--stream", "no.such.stream", "--rate", "1e-6"},
       {"at --rate 1e-06 this row comes 1000000000000 s after the first one",
        "the maximum is 3162240000 s"}},
      {{"fit", file, "--dt", "0"}, {"'0' is not a time from 1e-09 to"}},
      {{"fit", file, "--dt", "1e-9"}, {"--dt 1e-09 makes 4000000000000000 samples"}},
      {{"fit", file, "--method", "rounded", "--time-scale", "0", "--dt", "1"},
       {"'0' is not a number in the range above 0, at most 1e100 s"}},
      {{"methods", "--against", curve, "--every", "0"}, {"'0' is not a time from 1e-06 to"}},
  });
}

}  // namespace
}  // namespace splinecast::apps
