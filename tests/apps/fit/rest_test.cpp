#include "apps/fit/rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "apps/fit/curve.hpp"
#include "apps/streams/report.hpp"
#include "splinecast/fit.hpp"
#include "splinecast/method.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

namespace splinecast::apps {
namespace {

using ipc::EndKind;
using nlohmann::json;
using testing::LiveStream;
using testing::run;
using testing::TestFolder;

/// A motion that begins at rest, with a limit that its spline keeps, and with a wall shortly after
/// its last waypoint or none.
struct RandomEnd {
  double interval = 0.02;
  std::vector<double> positions{};
  MotionLimits limits{};

  explicit RandomEnd(std::uint64_t seed) : random_(seed) {
    if (seed % 3 != 0) interval = between(0.02, 0.3);
    if (seed % 2 == 0) {
      become_smooth();
    } else {
      become_rough();
    }
    const double least = *std::ranges::min_element(positions);
    const double most = *std::ranges::max_element(positions);
    limits.acceleration = {peak() * between(1.5, 5)};
    limits.lower = {least - 10};
    limits.upper = {most + (seed % 5 == 0 ? between(0, 0.01) : 10) * (most - least)};
  }
  [[nodiscard]] Time time(std::size_t i) const {
    return LiveStream::kNow + std::chrono::milliseconds(50) +
           Time(std::llround(1e9 * interval * static_cast<double>(i)));
  }
  [[nodiscard]] WaypointTable table() const {
    WaypointTable table;
    table.names = {"x"};
    table.positions = positions;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      table.times.push_back(time(i));
      table.lines.push_back(i + 1);
    }
    return table;
  }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// A velocity of 1 − cos, which ends at any phase.
  void become_smooth() {
    const double amplitude = between(0.1, 1);
    const double omega = between(1, 5);
    const auto count = static_cast<int>(between(10, 100));
    for (int i = 0; i < count; ++i) {
      const double phase = omega * interval * i;
      positions.push_back(amplitude * (phase - std::sin(phase)));
    }
  }
  /// Rest, then some random positions.
  void become_rough() {
    positions.assign(12, 0);
    for (auto count = static_cast<int>(between(1, 8)); count > 0; --count) {
      positions.push_back(between(-1, 1));
    }
  }
  [[nodiscard]] double peak() const {
    const PiecewisePolynomial curve = fit(table().waypoints(), {.interpolant = {.method = &c2()}});
    State state(1);
    double most = 0;
    for (const Time t : curve.breaks()) {
      curve.evaluate(t, state.ref());
      most = std::max(most, std::abs(state.acceleration()[0]));
    }
    return most;
  }

  std::mt19937_64 random_;
};

/// Compares a fitted curve with that of a live stream that has received all its waypoints and
/// `finish` before its time.
void expect_as_streamed(const RandomEnd& motion, const FittedCurve& found) {
  LiveStream live({.limits = motion.limits}, 1024, {.history = std::chrono::seconds(2)});
  for (std::size_t i = 0; i < motion.positions.size(); ++i) {
    live.send({.time = motion.time(i), .position = std::span(&motion.positions[i], 1)});
  }
  live.drain();
  live.finish({.kind = ConditionKind::halt, .value = {}});
  for (int i = 0; i < 10'000 && !live.solver.summary().finished; ++i) live.solver.step(live.clock);
  ASSERT_TRUE(live.solver.summary().finished);
  ASSERT_EQ(to_string(found.end), to_string(live.solver.summary().ending()));
  ASSERT_EQ(found.late, live.solver.summary().end_lateness);
  const Time end = found.curve.breaks().back();
  const Time step = (end - motion.time(0)) / 500;
  State state(1);
  for (Time t = motion.time(0); t < end; t += step) {
    found.curve.evaluate(t, state.ref());
    ASSERT_NEAR(state.position()[0], live.position_at(t), 1e-9);
    ASSERT_NEAR(state.velocity()[0], live.state.velocity()[0], 1e-7);
  }
}

FittedCurve fitted(const RandomEnd& motion, bool online) {
  CurveOptions options{.start = Condition{.kind = ConditionKind::halt, .value = {}},
                       .end = AtRest{},
                       .online = online};
  options.rest.limits = motion.limits;
  return fit_table(motion.table(), c2(), options);
}

TEST(Rest, IsThatOfALiveStream) {
  std::array<int, ipc::kEndKinds> ends{};
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    const RandomEnd motion(seed);
    const FittedCurve found = fitted(motion, true);
    expect_as_streamed(motion, found);
    if (HasFatalFailure()) return;
    ++ends.at(static_cast<std::size_t>(found.end));
  }
  EXPECT_GT(ends[static_cast<std::size_t>(EndKind::as_requested)], 0);
  EXPECT_GT(ends[static_cast<std::size_t>(EndKind::slowed)], 0);
  EXPECT_GT(ends[static_cast<std::size_t>(EndKind::entered)], 0);
}

TEST(Rest, OfABatchIsNearThatOfAStream) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    const RandomEnd motion(seed);
    const FittedCurve online = fitted(motion, true);
    const FittedCurve batch = fitted(motion, false);
    ASSERT_EQ(to_string(batch.end), to_string(online.end));
    ASSERT_NEAR(to_seconds(batch.late), to_seconds(online.late), 1e-9);
  }
}

/// A line at the velocity 1, which ends at full speed.
std::string line() {
  std::ostringstream csv("t,x\n", std::ios::ate);
  for (int i = 0; i <= 100; ++i) csv << i * 0.02 << ',' << i * 0.02 << '\n';
  return csv.str();
}

TEST(Rest, IsTheDefaultOfCheck) {
  const TestFolder folder;
  const auto file = folder.write("line.csv", line());
  const auto report = json::parse(run({"check", file, "--max-acceleration", "5", "--json"}).out);
  EXPECT_EQ(report.at("keeps_limits"), true);
  EXPECT_EQ(report.at("end").at("kind"), "slowed");
  EXPECT_GT(report.at("end").at("lateness_ns"), 100'000'000);
  EXPECT_EQ(report.at("end_ns").get<std::int64_t>(),
            2'000'000'000 + report.at("end").at("lateness_ns").get<std::int64_t>());
  const auto halted = run({"check", file, "--max-acceleration", "5", "--end", "halt"});
  EXPECT_EQ(halted.code, 3);
  const auto text = run({"check", file, "--max-acceleration", "5"});
  EXPECT_NE(text.out.find("slowed down on its path and rests at the last waypoint"),
            std::string::npos);
}

TEST(Rest, WithoutRoomForAnotherEndIsTheShortestStop) {
  const TestFolder folder;
  const auto file = folder.write("jump.csv", "t,x\n0,0\n0.02,1\n");
  const auto report = json::parse(run({"check", file, "--max-acceleration", "10", "--json"}).out);
  EXPECT_EQ(report.at("end").at("kind"), "stopped");
  EXPECT_EQ(report.at("keeps_limits"), true);
  EXPECT_NEAR(report.at("end_ns").get<double>(), 20e6 + 1.5e9 * 50 / 10, 1e3);
}

TEST(Rest, IsClampedWhereNoLiveStreamEnds) {
  const TestFolder folder;
  const auto file = folder.write("line.csv", line());
  const auto batch = run({"fit", file, "--end", "rest", "--dt", "0.1"});
  EXPECT_EQ(batch.out, run({"fit", file, "--end", "clamped", "--dt", "0.1"}).out);
  EXPECT_NE(batch.err.find("'rest' is now 'clamped'"), std::string::npos);
  const auto online = run({"fit", file, "--online", "--end", "rest", "--emit", "pp"});
  ASSERT_EQ(online.code, 0) << online.err;
  EXPECT_GT(json::parse(online.out).at("breaks_ns").back(), 2'000'000'000);
}

}  // namespace
}  // namespace splinecast::apps
