#include "ipc/layout/header.hpp"

#include <cstring>

#include "ipc/layout/areas.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/method.hpp"

namespace splinecast::ipc {

RegionHeader decode_header(std::span<const Word> words) noexcept {
  RegionHeader header{};
  decode(kHeaderRows, words.data(), header);
  return header;
}

RegionHeader copy_header(std::span<const std::byte> region) {
  if (region.size() < kBodyOffset) {
    throw BadRegion("region has " + std::to_string(region.size()) +
                    " bytes, fewer than its first " + std::to_string(kBodyOffset));
  }
  static_assert(kEpoch < kOwnerPid && kEpoch < kOwnerSince);  // loaded first
  std::array<Word, kHeaderWords> copy{};
  const auto words = words_at(region, 0, kHeaderWords);
  for (std::size_t i = 0; i < copy.size(); ++i) copy[i] = load(words[i], std::memory_order_acquire);
  return decode_header(copy);
}

void write_header(std::span<std::byte> region, const RegionHeader& header) noexcept {
  std::array<Word, kHeaderWords> words{};
  encode(kHeaderRows, header, words.data());
  std::memcpy(region.data(), words.data(), sizeof words);
}

bool smooths(const RegionHeader& header) noexcept {
  const Method* const method = find_method(header.method);
  return method != nullptr && method->smooths();
}

std::vector<Dimension> dimensions_of(const RegionHeader& header) {
  std::vector<Dimension> dimensions;
  for (std::size_t d = 0; d < header.dimensions; ++d) {
    dimensions.push_back(
        {.kind = static_cast<DimensionKind>(header.dimension_kind[d]), .period = header.period[d]});
  }
  return dimensions;
}

}  // namespace splinecast::ipc
