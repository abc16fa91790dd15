#include "apps/mcap/format/fields.hpp"

#include <fmt/format.h>

namespace splinecast::apps::mcap {

std::span<const std::byte> FieldReader::take(std::uint64_t size) {
  const auto left = rest();
  if (size > left.size()) {
    source_.refuse(begin_ + used_,
                   fmt::format("a field of {} bytes goes beyond its record, which has {} left",
                               size, left.size()));
  }
  used_ += size;
  return left.first(size);
}

Time FieldReader::time() {
  const auto count = number<std::uint64_t>();
  if (count > static_cast<std::uint64_t>(Time::max().count())) {
    source_.refuse(begin_ + used_ - sizeof count,
                   fmt::format("time {} ns is above {} ns", count, Time::max().count()));
  }
  return Time(static_cast<std::int64_t>(count));
}

std::string_view FieldReader::string() {
  const auto text = bytes<std::uint32_t>();
  return {reinterpret_cast<const char*>(text.data()), text.size()};  // NOLINT(*-reinterpret-cast)
}

FieldReader FieldReader::entries() {
  const auto size = number<std::uint32_t>();
  FieldReader entries = *this;
  entries.begin_ = begin_ + used_;
  entries.content_ = take(size);
  entries.used_ = 0;
  return entries;
}

Pairs FieldReader::pairs() {
  Pairs pairs;
  for (FieldReader entry = entries(); !entry.rest().empty();) {
    if (pairs.size() == kMostPairs) {
      source_.refuse(begin_, fmt::format("a record has more than {} keys", kMostPairs));
    }
    const auto key = entry.string();
    pairs.insert_or_assign(std::string(key), entry.string());
  }
  return pairs;
}

std::map<std::uint16_t, std::uint64_t> FieldReader::counts() {
  std::map<std::uint16_t, std::uint64_t> counts;
  for (FieldReader entry = entries(); !entry.rest().empty();) {
    const auto id = entry.number<std::uint16_t>();
    counts[id] = entry.number<std::uint64_t>();
  }
  return counts;
}

}  // namespace splinecast::apps::mcap
