#include "apps/mcap/format/record.hpp"

#include <algorithm>

#include "apps/mcap/format/fields.hpp"

namespace splinecast::apps::mcap {

bool Records::next(Record& record) noexcept {
  const auto rest = source_.bytes.subspan(offset_);
  if (rest.size() < kRecordHeader) return false;
  const auto size = load<std::uint64_t>(rest.data() + 1);
  if (size > rest.size() - kRecordHeader) return false;
  record = {static_cast<Opcode>(rest[0]), offset_, rest.subspan(kRecordHeader, size)};
  offset_ += record.size();
  return true;
}

bool has_magic(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= kMagic.size() && std::ranges::equal(bytes.first(kMagic.size()), kMagic);
}

}  // namespace splinecast::apps::mcap
