#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "support/live_stream.hpp"

/// A splice is shaped by the waypoints before it: how far back the solver looks for them.
namespace splinecast::ipc {
namespace {

using core::Time;
using std::chrono::milliseconds;
using Live = testing::LiveStream;

/// Positions along the splice that leads out of a rest, behind a motion that was stopped `stops`
/// times.
std::vector<double> way_out_of_rest(int stops, bool is_taken_over) {
  Live live;
  live.put_all(50, 200);
  live.clock.time = Live::kNow + milliseconds(190);
  live.drain();
  for (int i = 0; i < stops; ++i) {
    live.clock.time += milliseconds(5);
    EXPECT_EQ(live.replace(live.clock.time, {}), AppendStatus::accepted);
    live.drain();
  }
  live.clock.time = Live::kNow + milliseconds(1000);
  live.drain();
  const Time first = Live::kNow + milliseconds(1500);
  EXPECT_EQ(live.put(first), AppendStatus::accepted);
  live.drain();
  if (is_taken_over) live.replace_solver();
  EXPECT_EQ(live.put(first + milliseconds(100)), AppendStatus::accepted);
  live.drain();
  std::vector<double> positions;
  for (int ms = 1000; ms < 1500; ms += 50) {
    positions.push_back(live.position_at(Live::kNow + milliseconds(ms)));
  }
  return positions;
}

TEST(LookBack, ForWaypointsBeforeASpliceIsTheSameAfterATakeover) {
  for (int stops = 0; stops < 24; ++stops) {
    EXPECT_EQ(way_out_of_rest(stops, true), way_out_of_rest(stops, false)) << stops << " stops";
  }
}

}  // namespace
}  // namespace splinecast::ipc
