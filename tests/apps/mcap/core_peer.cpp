#include "tests/apps/mcap/core_peer.hpp"

#include <fmt/format.h>

namespace splinecast::testing {

using nlohmann::json;

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return text;
}

json McapPeers::read_with(const std::string& command, const std::string& file) const {
  const Ended ended = peer("peer.mjs", {command, folder_.write("read.mcap", file)});
  EXPECT_EQ(ended.code, 0) << ended.err;
  return ended.code == 0 ? json::parse(ended.out) : json();
}

json json_of(const std::vector<KeptMessage>& messages) {
  json list = json::array();
  for (const KeptMessage& m : messages) {
    list.push_back({m.topic, m.sequence, std::to_string(m.log_time), std::to_string(m.publish_time),
                    hex(m.data)});
  }
  return list;
}

}  // namespace splinecast::testing
