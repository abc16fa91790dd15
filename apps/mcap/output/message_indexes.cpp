#include "apps/mcap/output/message_indexes.hpp"

#include <algorithm>

namespace splinecast::apps::mcap {

void MessageIndexes::add(std::uint16_t channel, Time log_time, std::uint64_t offset) {
  const auto time = static_cast<std::uint64_t>(std::max(log_time, Time::zero()).count());
  start_time_ = channels_.empty() ? time : std::min(start_time_, time);
  end_time_ = std::max(end_time_, time);
  if (entries_.size() <= channel) entries_.resize(channel + std::size_t{1});
  auto& entries = entries_[channel];
  if (entries.empty()) channels_.push_back(channel);
  entries.push_back({time, offset});
}

void MessageIndexes::clear() {
  for (const std::uint16_t channel : channels_before_) {
    if (entries_[channel].empty()) std::vector<Entry>().swap(entries_[channel]);
  }
  for (const std::uint16_t channel : channels_) entries_[channel].clear();
  channels_before_ = channels_;
  channels_.clear();
  start_time_ = 0;
  end_time_ = 0;
}

}  // namespace splinecast::apps::mcap
