#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps::mcap {

/// Where the messages of a chunk are, channel by channel. Reuses the memory of the chunk before,
/// and frees that of channels which have no messages any more.
class MessageIndexes {
 public:
  /// Log time in ns, and offset of the message in the uncompressed records: as in a file.
  struct Entry {
    std::uint64_t time;
    std::uint64_t offset;
  };

  void add(std::uint16_t channel, Time log_time, std::uint64_t offset);
  void clear();

  /// The channels with messages, in the order of their first message.
  [[nodiscard]] const std::vector<std::uint16_t>& channels() const noexcept { return channels_; }
  [[nodiscard]] std::span<const Entry> of(std::uint16_t channel) const {
    return entries_.at(channel);
  }
  /// Earliest and latest log time; 0 without messages.
  [[nodiscard]] std::uint64_t start_time() const noexcept { return start_time_; }
  [[nodiscard]] std::uint64_t end_time() const noexcept { return end_time_; }

 private:
  std::vector<std::uint16_t> channels_;
  std::vector<std::uint16_t> channels_before_;  ///< those of the chunk before
  std::vector<std::vector<Entry>> entries_;     ///< by the channel's number
  std::uint64_t start_time_ = 0;
  std::uint64_t end_time_ = 0;
};

}  // namespace splinecast::apps::mcap
