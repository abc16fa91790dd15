#include "apps/streams/report.hpp"

#include <gtest/gtest.h>

namespace splinecast::apps {
namespace {

TEST(StreamReport, WritesThe64BitStreamIdAsAString) {
  ipc::RegionHeader header{};
  header.stream_id = (std::uint64_t{1} << 63U) + 1;
  header.dimensions = 1;
  ipc::StreamInfo info;
  info.stream = "arm";
  info.waypoints = header;
  EXPECT_EQ(to_json(info)["stream_id"], "9223372036854775809");
}

}  // namespace
}  // namespace splinecast::apps
