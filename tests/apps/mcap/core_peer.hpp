#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/mcap/npm_peers.hpp"
#include "tests/apps/mcap/recording.hpp"

namespace splinecast::testing {

inline constexpr std::array kCompressions{
    apps::mcap::Compression::none, apps::mcap::Compression::lz4, apps::mcap::Compression::zstd};

/// The peer is @mcap/core.
class McapPeers : public NpmPeersTest {
 protected:
  /// What the peer reads of a complete file, with its index and as a stream.
  [[nodiscard]] nlohmann::json read(const std::string& file) const {
    return read_with("read", file);
  }
  /// What it reads of the beginning of a file.
  [[nodiscard]] nlohmann::json read_beginning(const std::string& file) const {
    return read_with("beginning", file);
  }

  TestFolder folder_;

 private:
  [[nodiscard]] nlohmann::json read_with(const std::string& command, const std::string& file) const;
};

/// Bytes and messages, as peer.mjs prints them.
[[nodiscard]] std::string hex(const std::string& bytes);
[[nodiscard]] nlohmann::json json_of(const std::vector<KeptMessage>& messages);

}  // namespace splinecast::testing
