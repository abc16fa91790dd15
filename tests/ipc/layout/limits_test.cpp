#include "ipc/layout/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

RegionHeader header_of(std::size_t dimensions) {
  return make_header({.dimensions = dimensions,
                      .names = {},
                      .units = {},
                      .clock = StreamClock::recorded,
                      .start = {}},
                     7);
}

TEST(HeaderLimits, AHeaderOfZerosHasNoLimits) {
  const RegionHeader header = header_of(3);
  EXPECT_EQ(motion_limits(header), MotionLimits{});
  EXPECT_EQ(beyond(header), Beyond::report);
}

TEST(HeaderLimits, AreReadAsTheyWereWritten) {
  const MotionLimits limits{.velocity = {1, 0, 2},
                            .acceleration = {},
                            .jerk = {0, 0, 5},
                            .lower = {-1, -kUnbounded, 0},
                            .upper = {kUnbounded, kUnbounded, 3}};
  RegionHeader header = header_of(3);
  put_limits(limits, header);
  EXPECT_EQ(motion_limits(header), limits);
  EXPECT_EQ(header.lower_bound[1], 0);
  EXPECT_EQ(header.upper_bound[1], 0);
  put_limits({.upper = {0, 0, 0}}, header);
  EXPECT_EQ(motion_limits(header).upper, (std::vector<double>{0, 0, 0}));
  EXPECT_TRUE(motion_limits(header).lower.empty());
  put_limits({}, header);
  EXPECT_EQ(motion_limits(header), MotionLimits{});
  EXPECT_THROW(put_limits({.velocity = {1}}, header), std::invalid_argument);
}

/// A valid board header.
RegionHeader board_header(std::size_t dimensions) {
  RegionHeader header = header_of(dimensions);
  header.kind = static_cast<std::uint64_t>(RegionKind::spline);
  header.capacity = 32;
  header.settle = 8;
  header.stop_time = 1;
  header.freeze_ahead = 1;
  header.min_entry = 1;
  header.time_scale = 1;
  header.rules = kRules;
  const BoardLayout layout = BoardLayout::of(dimensions, 32, header.control, false);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  return header;
}

TEST(HeaderLimits, ABoardWithInvalidLimitsIsRefused) {
  ASSERT_NO_THROW((void)checked_board_layout(board_header(2), board_header(2).region_bytes));
  const std::vector<std::pair<std::string, std::function<void(RegionHeader&)>>> cases{
      {"velocity limit", [](RegionHeader& h) { h.max_velocity[1] = -1; }},
      {"jerk limit", [](RegionHeader& h) { h.max_jerk[0] = kUnbounded; }},
      {"lower bound", [](RegionHeader& h) { h.lower_bound[0] = 1; }},
      {"upper bound", [](RegionHeader& h) { h.upper_bound[0] = std::nan(""); }},
      {"no bounds",
       [](RegionHeader& h) {
         h.dimension_kind[0] = static_cast<std::uint64_t>(DimensionKind::periodic);
         h.period[0] = 360;
         h.upper_bound[0] = 1;
       }},
      {"action beyond the limits", [](RegionHeader& h) { h.beyond = 3; }},
      {"rules", [](RegionHeader& h) { h.rules = 0; }},
      {"rules", [](RegionHeader& h) { h.rules = kRules + 1; }}};
  for (const auto& [message, damage] : cases) {
    RegionHeader header = board_header(2);
    damage(header);
    try {
      (void)checked_board_layout(header, header.region_bytes);
      FAIL() << message;
    } catch (const BadRegion& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

TEST(HeaderLimits, NamedLimitsMatchNamesThatTheHeaderTruncated) {
  const std::string name = "left_arm_shoulder_pan_joint_of_the_second_robot";
  const RegionHeader header = make_header({.dimensions = 2,
                                           .names = {name, "q2"},
                                           .units = {},
                                           .clock = StreamClock::recorded,
                                           .start = {}},
                                          7);
  SolverOptions options;
  options.named_limits = {{.name = name, .velocity = 2}, {.name = "q2", .acceleration = 3}};
  options.limits = MotionLimits{.acceleration = {7}};
  const MotionLimits limits = limits_for(options, header);
  EXPECT_EQ(limits.velocity, (std::vector<double>{2, 0}));
  EXPECT_EQ(limits.acceleration, (std::vector<double>{7, 7}));
  options.limits = MotionLimits{.acceleration = {7, 8, 9}};
  EXPECT_THROW((void)limits_for(options, header), BadRequest);
}

}  // namespace
}  // namespace splinecast::ipc
