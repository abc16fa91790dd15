#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/record/executed/executed_file.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "tests/apps/rate/rate.hpp"
#include "tests/apps/record/live_reader.hpp"
#include "tests/apps/record/recorded.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// The executed curve of a recording.
namespace splinecast::apps::record {
namespace {

/// A live stream of one dimension.
StreamOptions live_options() {
  StreamOptions options{.stream = "arm"};
  options.waypoints.dimensions = 1;
  options.waypoints.clock = static_cast<std::uint64_t>(StreamClock::monotonic);
  options.spline = options.waypoints;
  return options;
}

/// A segment of 10 ns that has the number as its position, in motion unless it is a hold.
ipc::SegmentCopy segment(ipc::Word number, std::int64_t left, SegmentKind kind) {
  const double v = kind == SegmentKind::hold ? 0.0 : 1.0;
  ipc::SegmentCopy made{.number = number, .next = number + 1};
  made.left = Time(left);
  made.right = made.natural_right = Time(left + 10);
  made.kind = kind;
  made.coefficients = {static_cast<double>(number), v, 0, 0};
  return made;
}

class ExecutedCurveOfOneDimension : public ::testing::Test {
 protected:
  struct Got {
    SampleStatus status{};
    double position = 0;
  };
  [[nodiscard]] Got at(std::int64_t t) {
    State state(1);
    const SampleStatus status = curve.sample(Time(t), 0, Time(t), state.ref()).status;
    return {status, has_values(status) ? std::floor(state.position()[0]) : 0};
  }
  void expect(std::int64_t t, SampleStatus status, double position = 0) {
    const Got got = at(t);
    EXPECT_EQ(got.status, status) << t;
    EXPECT_EQ(got.position, position) << t;
  }

  ExecutedCurve curve{live_options()};
};

TEST_F(ExecutedCurveOfOneDimension, HasStatusesAsAReaderAtThatTime) {
  curve.take(segment(5, 100, SegmentKind::spline));
  curve.take(segment(6, 110, SegmentKind::stop));
  curve.take(segment(7, 120, SegmentKind::hold));
  curve.take(segment(9, 140, SegmentKind::entry));
  expect(99, SampleStatus::before_history);
  expect(100, SampleStatus::settled, 5);
  expect(110, SampleStatus::stopping, 6);
  expect(120, SampleStatus::holding, 7);
  expect(130, SampleStatus::no_data);  // segment 8 is not there
  expect(139, SampleStatus::no_data);
  expect(140, SampleStatus::settled, 9);
  expect(150, SampleStatus::no_data);  // not known whether it rests
  EXPECT_EQ(curve.parts().size(), 2U);
}

TEST_F(ExecutedCurveOfOneDimension, IsHeldBeforeItsFirstSegmentUnlessItStartsInMotion) {
  curve.take(segment(1, 100, SegmentKind::hold));
  expect(99, SampleStatus::holding, 1);
  curve = ExecutedCurve(live_options());
  curve.take(segment(1, 100, SegmentKind::spline));
  expect(99, SampleStatus::no_data);
}

TEST_F(ExecutedCurveOfOneDimension, ASegmentReplacesThoseThatItBeginsBefore) {
  curve.take(segment(5, 100, SegmentKind::spline));
  curve.take(segment(6, 110, SegmentKind::spline));
  curve.take(segment(8, 110, SegmentKind::entry));
  expect(115, SampleStatus::settled, 8);
  EXPECT_EQ(curve.segments().size(), 2U);
}

TEST_F(ExecutedCurveOfOneDimension, RestsAfterAStopAsFarAsThatHasSettled) {
  curve.take(segment(6, 110, SegmentKind::stop));
  ipc::Summary summary;
  summary.newest = 6;
  summary.settled_until = Time(200);
  curve.take(Published{.summary = summary, .open = {}}, Time(200));
  expect(120, SampleStatus::holding, 6);
  expect(199, SampleStatus::holding, 6);
  expect(200, SampleStatus::no_data);
  summary.newest = 7;  // another motion follows, of which the file has nothing
  curve.take(Published{.summary = summary, .open = {}}, Time(200));
  expect(120, SampleStatus::no_data);
}

TEST_F(ExecutedCurveOfOneDimension, ASegmentThatHasNotSettledToItsEndCountsUpToThere) {
  curve.take(segment(6, 110, SegmentKind::spline));
  ipc::Summary summary;
  summary.newest = 9;
  const ipc::OpenSegment open{.until = Time(125), .segment = segment(7, 120, SegmentKind::entry)};
  curve.take(Published{.summary = summary, .open = open}, Time(125));
  expect(124, SampleStatus::settled, 7);
  expect(125, SampleStatus::no_data);
  EXPECT_EQ(curve.parts().front().breaks().back(), Time(125));
  curve.take(segment(7, 120, SegmentKind::spline));  // cut, and settled
  expect(129, SampleStatus::settled, 7);
}

TEST_F(ExecutedCurveOfOneDimension, AfterTheFinishItIsSettledToItsEnd) {
  curve.take(segment(6, 110, SegmentKind::stop));
  ipc::Summary summary;
  summary.newest = 7;
  summary.finished = true;
  curve.take(Published{.summary = summary, .open = {}}, Time(115));
  expect(114, SampleStatus::stopping, 6);
  expect(115, SampleStatus::settled, 6);
  expect(120, SampleStatus::settled, 6);
  expect(121, SampleStatus::holding, 6);
}

/// The largest step of position and velocity at the breaks of a curve, at unit length of
/// quaternions.
double largest_step(const PiecewisePolynomial& curve, const DimensionKinds& kinds) {
  State left(curve.dimensions());
  State right(curve.dimensions());
  double largest = 0;
  const auto evaluate = [&](std::size_t i, double u, State& state) {
    core::evaluate(curve.order_of(i), curve.coefficients(i), u, state.ref());
    const StateRef all = state.ref();
    kinds.normalise_quaternions(all.position, all.velocity, all.acceleration);
  };
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    evaluate(i - 1, curve.seconds(i - 1), left);
    evaluate(i, 0, right);
    for (std::size_t k = 0; k < 2 * curve.dimensions(); ++k) {
      largest = std::max(largest, std::abs(left.values()[k] - right.values()[k]));
    }
  }
  return largest;
}

/// Every kept recording, of all methods, ends and laws.
TEST(ExecutedCurves, OfKeptRecordingsHaveNoStepsOfPositionAndVelocity) {
  REQUIRE_MCAP();
  std::size_t segments = 0;
  for (const std::string& path : testing::recordings_in(testing::own_file("recordings"))) {
    for (const std::string& name : executed_streams(path)) {
      const ExecutedStream stream = read_executed(path, name);
      const auto parts = stream.curve.parts();
      EXPECT_EQ(parts.size(), 1U) << path;
      for (const PiecewisePolynomial& part : parts) {
        segments += part.segments();
        EXPECT_LT(largest_step(part, ipc::dimension_kinds(stream.curve.header())), 1e-9) << path;
      }
    }
  }
  EXPECT_GT(segments, 1000U);
}

class ExecutedUnderALaw : public Rate {
 protected:
  void SetUp() override { REQUIRE_MCAP(); }
  [[nodiscard]] std::string path() const { return folder_.path("run.mcap"); }

  /// Waits until the arm moves.
  [[nodiscard]] bool moves() {
    Reader reader(arm(), testing::kPatience);
    State state(1);
    return testing::await([&] {
      return has_values(reader.preview(clock_.now(), state)) && state.velocity()[0] > 0.5;
    });
  }

  /// Records these streams while the law slows down, holds and resumes. Returns what a reader got.
  std::vector<testing::LiveRow> record(std::vector<std::string> streams) {
    const testing::Process solver({"solve", law(), arm()});
    EXPECT_EQ(rate({"1", "--ramp", "0.01", "--wait", "0"}).code, 0);
    streams.insert(streams.end(), {"-o", path()});
    testing::Process recorder = testing::start_recorder(streams);
    const testing::Process replay(
        {"replay", line_file(4000), "--stream", arm(), "--law", law(), "--lead", "1500"});
    EXPECT_TRUE(moves());
    testing::LiveReader reader(arm());
    for (const char* const wanted : {"0.4", "0", "1"}) {
      EXPECT_EQ(rate({wanted, "--ramp", "0.2"}).code, 0);
      EXPECT_TRUE(await_rate(std::stod(wanted)));
    }
    std::vector<testing::LiveRow> rows = reader.stop();
    recorder.signal(SIGINT);
    (void)recorder.wait();
    return rows;
  }
};

TEST_F(ExecutedUnderALaw, ASampleAtAHostTimeHasTheBitsThatAReaderGot) {
  const auto rows = record({law(), arm()});
  EXPECT_GT(testing::expect_sampled_alike(path(), arm(), rows), 100U);
}

TEST_F(ExecutedUnderALaw, WithoutTheLawTimesAreOfTheStreamAndThatIsSaid) {
  (void)record({arm()});
  const testing::Ended ended = testing::run({"sample", path(), arm(), "--rate", "10"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_NE(ended.err.find("times and derivatives are of stream time: the law '" + law() +
                           "' is not in "),
            std::string::npos)
      << ended.err;
}

/// A recorded stream of two dimensions in a file.
class ExecutedInVerbs : public testing::RecorderTest {
 protected:
  void SetUp() override {
    RecorderTest::SetUp();
    if (IsSkipped()) return;
    SolverOptions options;
    options.limits.emplace().velocity = {2, 0};
    testing::SteppedStream stream(name(), options);
    testing::Process recorder = testing::start_recorder({name(), "-o", path(), "--until-finished"});
    recorder.await_message("'" + name() + "': recording");
    stream.append_until(100);
    stream.finish();
    EXPECT_EQ(recorder.wait().code, 0);
  }
  [[nodiscard]] std::string path() const { return folder_.path("run.mcap"); }
  [[nodiscard]] const std::string& name() const { return stream_.name(); }

  void expect_error(const std::vector<std::string>& arguments, int code,
                    const std::string& message) {
    const testing::Ended ended = testing::run(arguments);
    EXPECT_EQ(ended.code, code) << ended.err;
    EXPECT_NE(ended.err.find(message), std::string::npos) << ended.err;
  }

  testing::TestFolder folder_;
  testing::TestStream stream_;
};

TEST_F(ExecutedInVerbs, FitAndSampleHaveTheSameCurve) {
  const testing::Ended fitted = testing::run({"fit", path(), "--dt", "0.013"});
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_NE(fitted.err.find("the executed curve, "), std::string::npos) << fitted.err;
  const std::string at = folder_.write("times.csv", fitted.out);
  const testing::Ended sampled = testing::run({"sample", path(), name(), "--at", at});
  ASSERT_EQ(sampled.code, 0) << sampled.err;
  std::string without;
  for (std::size_t begin = 0; begin < sampled.out.size();) {
    const std::size_t end = sampled.out.find('\n', begin);
    std::string line = sampled.out.substr(begin, end - begin);
    for (int i = 0; i < 2; ++i) line.resize(line.rfind(','));
    without += line + "\n";
    begin = end + 1;
  }
  EXPECT_EQ(without, fitted.out);
}

TEST_F(ExecutedInVerbs, CheckUsesTheLimitsOfTheStreamUnlessOthersAreGiven) {
  const auto check = [&](std::vector<std::string> further) {
    std::vector<std::string> arguments{"check", path(), "--json", "--quiet"};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return nlohmann::json::parse(testing::run(arguments).out);
  };
  const auto of_stream = check({});
  EXPECT_EQ(of_stream["worst"]["velocity"]["limit"], 2.0);
  EXPECT_EQ(of_stream["method"], "the executed curve");
  EXPECT_EQ(check({"--max-velocity", "1e9"})["keeps_limits"], true);
  EXPECT_EQ(check({"--max-velocity", "1e-9"})["keeps_limits"], false);
}

TEST_F(ExecutedInVerbs, WhatBelongsToWaypointsNeedsThem) {
  expect_error({"fit", path(), "--dt", "0.1", "--method", "akima"}, 2,
               "--method: the file is a recording, of which the executed curve is taken; this goes "
               "with its waypoints: add --waypoints");
  expect_error({"check", path(), "--gap", "1"}, 2, "--gap: the file is a recording");
  EXPECT_EQ(testing::run({"fit", path(), "--waypoints", "--method", "akima", "--dt", "1"}).code, 0);
}

TEST_F(ExecutedInVerbs, NamesThatAreNotThereAreRefusedWithThoseThatAre) {
  expect_error({"sample", path(), "other", "--rate", "1"}, 2, "it has '" + name() + "'");
  expect_error({"fit", path(), "--topic", "other", "--dt", "1"}, 2, "it has '" + name() + "'");
  expect_error({"sample", name(), path(), "--rate", "1"}, 2, "it is not a recording of 'record'");
  expect_error({"sample", path(), name(), "--rate", "1", "--wait", "1"}, 2, "--wait");
  expect_error({"sample", name(), "--rate", "1"}, 2, "--rate: needs --count");
  expect_error({"sample", "a", "b", "c", "--rate", "1"}, 2, "two are a recording and a stream");
}

TEST_F(ExecutedInVerbs, TheReportHasTheExecutedCurve) {
  const std::string page = folder_.path("report.html");
  ASSERT_EQ(testing::run({"fit", path(), "--report", page}).code, 0);
  const std::string text = testing::read_file(page);
  EXPECT_NE(text.find(R"("curves":["executed"])"), std::string::npos);
  EXPECT_NE(text.find(R"("limits":[[null,null],[-2.0,2.0])"), std::string::npos);
  EXPECT_NE(text.find(R"("text":"finished, count 100")"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::apps::record
