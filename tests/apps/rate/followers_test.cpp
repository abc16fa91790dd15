#include <chrono>
#include <csignal>
#include <filesystem>
#include <regex>
#include <string>

#include "ipc/law/law_board.hpp"
#include "ipc/memory/names.hpp"
#include "tests/apps/rate/rate.hpp"

/// `rate` on a law that a stream follows: what a ramp does to it, and how the other verbs show it.
namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;

/// A stream that moves at 1 unit/s of stream time, with a limit of acceleration of 10 unit/s².
class MovingFollower : public Rate {
 protected:
  MovingFollower()
      : request_(rate({"1", "--ramp", "0.01", "--wait", "0"})),
        solver_({"solve", law(), arm(), "--max-acceleration", "10"}),
        replay_({"replay", line_file(4000), "--stream", arm(), "--law", law(), "--lead", "1500"}) {
    EXPECT_EQ(request_.code, 0) << request_.err;
    Reader reader(arm(), testing::kPatience);
    State state(1);
    EXPECT_TRUE(testing::await([&] {
      const SampleStatus status = reader.sample(clock_.now(), state);
      return status == SampleStatus::settled && std::abs(state.velocity()[0] - 1) < 1e-3 &&
             std::abs(state.acceleration()[0]) < 1e-2;
    }));
  }

  /// How many requests the operator has made, as far as they are in force.
  [[nodiscard]] ipc::Word requests() {
    ipc::LawBoard board(law(), {});
    EXPECT_TRUE(board.is_there());
    const auto all = board.commanders();
    return all.size() == 1 ? all.front().number : 0;
  }

  Ended request_;
  Process solver_;
  Process replay_;
};

/// The ramp that a message names.
double named_ramp(const std::string& message) {
  std::smatch found;
  const bool is_there =
      std::regex_search(message, found, std::regex("a ramp of ([0-9.]+) s would do"));
  return is_there ? std::stod(found[1]) : 0;
}

TEST_F(MovingFollower, ALowerRateBeyondALimitIsRequestedAndTheSufficientRampIsReported) {
  // The largest acceleration of a ramp from 1 to 0 in T is 1.5/T.
  const Ended held = rate({"0", "--ramp", "0.1"});
  EXPECT_EQ(held.code, 0);
  EXPECT_NE(held.err.find("requested: acceleration of '" + arm() +
                          "' in dimension x would be -15, limit 10"),
            std::string::npos)
      << held.err;
  EXPECT_GE(named_ramp(held.err), 0.15);
  EXPECT_LE(named_ramp(held.err), 0.15 * 1.12);
  EXPECT_TRUE(await_rate(0));
}

TEST_F(MovingFollower, AGentleRampIsLengthenedAsFarAsItMayBe) {
  // The largest acceleration of a ramp from 1 to 0 in T is 1.5/T, and the limit is 10. The longest
  // ramp is requested at once, then the one that suffices, unless this takes too long to find.
  ipc::Word before = 0;
  double worst = 0;
  for (int i = 0; i < 50 && requests() != before + 2; ++i) {
    EXPECT_EQ(rate({"1", "--ramp", "0.5"}).code, 0);
    ASSERT_TRUE(await_rate(1));
    before = requests();
    const Ended gentle = rate({"0", "--ramp", "0.1", "--gentle", "0.2", "--json"});
    EXPECT_EQ(gentle.code, 0);
    EXPECT_EQ(gentle.err, "");
    worst = nlohmann::json::parse(gentle.out)["effects"][0]["limit_ratio"];
    ASSERT_TRUE(await_rate(0));
  }
  EXPECT_GT(worst, 0.7);
  EXPECT_LE(worst, 1 + 1e-9);
  EXPECT_EQ(requests(), before + 2);
  EXPECT_EQ(rate({"0.5", "--ramp", "0.5"}).code, 0);
  ASSERT_TRUE(await_rate(0.5));
  // Not as long as it would have to be.
  const Ended short_one = rate({"0", "--ramp", "0.03", "--gentle", "0.05"});
  EXPECT_EQ(short_one.code, 0);
  EXPECT_EQ(requests(), before + 4) << "the longest ramp was not long enough";
  EXPECT_NE(short_one.out.find("rate 0 in 0.05 s"), std::string::npos) << short_one.out;
  EXPECT_NE(short_one.err.find("requested: acceleration"), std::string::npos) << short_one.err;
  EXPECT_TRUE(await_rate(0));
  EXPECT_EQ(rate({"0", "--ramp", "0.2", "--gentle", "0.1"}).code, 2);
}

TEST_F(MovingFollower, AHigherRateBeyondALimitIsRefusedUnlessItIsForced) {
  ASSERT_EQ(rate({"0", "--ramp", "0.1"}).code, 0);
  ASSERT_TRUE(await_rate(0));
  const Ended refused = rate({"1", "--ramp", "0.1"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("refused: acceleration of '" + arm() +
                             "' in dimension x would be 15, limit 10"),
            std::string::npos)
      << refused.err;
  const double enough = named_ramp(refused.err);
  EXPECT_GE(enough, 0.15);
  EXPECT_LE(enough, 0.15 * 1.12);
  EXPECT_NEAR(law_rate(), 0, kRounding);
  EXPECT_EQ(commander("operator")["rate"], 0);
  const Ended accepted = rate({"0.5", "--ramp", std::to_string(enough)});
  EXPECT_EQ(accepted.code, 0) << accepted.err;
  EXPECT_TRUE(await_rate(0.5));
  EXPECT_EQ(rate({"1", "--ramp", "0.01", "--force"}).code, 0);
  EXPECT_TRUE(await_rate(1));
}

TEST_F(MovingFollower, AHoldIsRequestedAlsoIfAFileOfAFollowerIsDamaged) {
  const testing::TestStream damaged;
  const std::string path = ipc::region_path(damaged.name(), ipc::RegionKind::spline);
  std::filesystem::copy_file(ipc::region_path(arm(), ipc::RegionKind::spline), path);
  std::filesystem::resize_file(path, 8192);
  const Ended held = rate({"0", "--ramp", "0.5"});
  EXPECT_EQ(held.code, 0);
  EXPECT_NE(held.err.find("'" + damaged.name() + "': the effect on it is not known: "),
            std::string::npos)
      << held.err;
  EXPECT_TRUE(await_rate(0));
}

TEST_F(MovingFollower, PrintsTheEffectAsJson) {
  const Ended ended = rate({"0.5", "--ramp", "0.1", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["law"], law());
  EXPECT_EQ(json["rate"], 0.5);
  ASSERT_EQ(json["effects"].size(), 1U);
  const auto& effect = json["effects"][0];
  EXPECT_EQ(effect["stream"], arm());
  EXPECT_NEAR(effect["velocity"][0].get<double>(), 1, 1e-2);
  EXPECT_GE(effect["acceleration"][0].get<double>(),
            7.4);  // 1.5 · 0.5/0.1, at a millisecond's grid
  EXPECT_GE(effect["limit_ratio"].get<double>(), 0.74);
  EXPECT_LE(effect["limit_ratio"].get<double>(), 1);
}

TEST_F(MovingFollower, IsShownByTheOtherVerbs) {
  EXPECT_EQ(shown()["followers"], nlohmann::json::array({arm()}));
  EXPECT_NE(rate().out.find("followed by " + arm()), std::string::npos);
  const auto of_arm = testing::info(arm());
  const auto of_law = testing::info(law());
  EXPECT_EQ(of_arm["clock"], "law");
  EXPECT_EQ(of_arm["law"], law());
  EXPECT_EQ(of_arm["law_id"], of_law["stream_id"]);
  EXPECT_EQ(of_law["clock"], "live");
  EXPECT_EQ(of_law["time_law"]["largest_rate"], 1.0);
  const std::string list = testing::run({"ls"}).out;
  EXPECT_TRUE(std::regex_search(list, std::regex(arm() + " +1 law "))) << list;
  const auto all = nlohmann::json::parse(testing::run({"ls", "--json"}).out);
  EXPECT_TRUE(std::ranges::any_of(all, [&](const auto& stream) {
    return stream["stream"] == arm() && stream["law"] == law();
  }));
}

TEST_F(MovingFollower, IsSampledInHostTimeByTheVerbSample) {
  const Ended sampled = testing::run({"sample", arm(), "--rate", "1000", "--count", "20"});
  ASSERT_EQ(sampled.code, 0) << sampled.err;
  EXPECT_EQ(std::ranges::count(sampled.out, '\n'), 21);
  EXPECT_NE(sampled.out.find(",settled\n"), std::string::npos) << sampled.out;
  EXPECT_EQ(sampled.out.find("history"), std::string::npos) << sampled.out;
}

TEST_F(MovingFollower, AHeldLawHoldsTheStreamAndItsReplay) {
  ASSERT_EQ(rate({"0", "--ramp", "0.3"}).code, 0);
  ASSERT_TRUE(await_rate(0));
  Reader reader(arm(), testing::kPatience);
  State first(1);
  ASSERT_EQ(reader.sample(clock_.now(), first), SampleStatus::settled);
  EXPECT_EQ(first.velocity()[0], 0);
  EXPECT_EQ(first.acceleration()[0], 0);
  // The replay has sent what is due within its lead of 1.5 s, and sends nothing more.
  const Time stream_time = reader.rate().stream_time;
  const auto newest = [&] { return Time(testing::info(arm())["solver"]["newest_knot_ns"]); };
  EXPECT_TRUE(testing::await(
      [&] { return newest() > stream_time + std::chrono::milliseconds(1500 - 50); }));
  const Time held = newest();
  EXPECT_LE(held, stream_time + std::chrono::milliseconds(1500));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(newest(), held);
  State last(1);
  ASSERT_EQ(reader.sample(clock_.now(), last), SampleStatus::settled);
  EXPECT_EQ(last.position()[0], first.position()[0]);
  ASSERT_EQ(rate({"1", "--ramp", "0.3"}).code, 0);
  EXPECT_TRUE(testing::await([&] { return newest() > held; }));
  EXPECT_EQ(testing::info(arm())["solver"]["underruns"], 0);
}

TEST_F(MovingFollower, ALawThatIsFollowedIsRemovedWithNowOnly) {
  replay_.signal(SIGINT);
  (void)replay_.wait();
  solver_.signal(SIGINT);
  (void)solver_.wait();
  const Ended refused = testing::run({"rm", law()});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("time law '" + law() + "' is followed by '" + arm() + "'"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(testing::run({"rm", "--now", law()}).code, 0);
  for (const std::vector<std::string>& later :
       {std::vector<std::string>{"sample", arm(), "--rate", "10", "--count", "1"},
        std::vector<std::string>{"solve", arm()}}) {
    const Ended lost = testing::run(later);
    EXPECT_EQ(lost.code, 4) << later[0];
    EXPECT_NE(lost.err.find("law lost: the time law '" + law() + "' has been removed"),
              std::string::npos)
        << lost.err;
  }
  EXPECT_EQ(testing::run({"rm", "--now", arm()}).code, 0);
}

TEST_F(Rate, AReplayUnderALawIsVerifiedToTheBit) {
  ASSERT_EQ(rate({"1", "--ramp", "0.05", "--wait", "0"}).code, 0);
  Process solver({"solve", law(), arm()});
  Process replay({"replay", line_file(40), "--stream", arm(), "--law", law(), "--verify"});
  ASSERT_TRUE(testing::await([&] { return !testing::info(arm()).is_null(); }));
  EXPECT_EQ(rate({"0.5", "--ramp", "0.05"}).code, 0);
  const Ended ended = replay.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.err.find("40 waypoints sent, "), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("all equal"), std::string::npos) << ended.err;
}

TEST_F(Rate, AReplayWaitsForItsLaw) {
  const auto missing =
      testing::run({"replay", line_file(4), "--stream", arm(), "--law", law(), "--wait", "0.01"});
  EXPECT_EQ(missing.code, 4) << missing.err;
  EXPECT_NE(missing.err.find("time law '" + law() + "' has not begun within 0.01 s"),
            std::string::npos)
      << missing.err;
  EXPECT_EQ(testing::run(
                {"replay", line_file(4), "--stream", arm(), "--law", law(), "--clock", "recorded"})
                .code,
            2);
  EXPECT_EQ(testing::run({"replay", line_file(4), "--stream", arm(), "--law", "a@b"}).code, 2);
  Process replay({"replay", line_file(4), "--stream", arm(), "--law", law(), "--lead", "5000"});
  Process solver({"solve", law(), arm()});
  ASSERT_EQ(rate({"1"}).code, 0);
  const Ended ended = replay.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
}

TEST_F(Rate, OnlyALawIsFollowed) {
  Process solver({"solve", law()});
  ASSERT_EQ(testing::run({"replay", line_file(4), "--stream", law(), "--clock", "recorded"}).code,
            0);
  const Ended ended =
      testing::run({"replay", line_file(4), "--stream", arm(), "--law", law(), "--wait", "1"});
  EXPECT_EQ(ended.code, 1);
  EXPECT_NE(ended.err.find("is not a time law"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace splinecast::apps
