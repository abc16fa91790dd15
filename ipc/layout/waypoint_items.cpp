#include "ipc/layout/waypoint_items.hpp"

#include "ipc/layout/areas.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

RingLayout RingLayout::of(std::size_t dimensions, std::size_t capacity,
                          std::size_t control) noexcept {
  const std::size_t stride =
      round_up(size_of(kItemFields).of(dimensions) * sizeof(Word), kCacheLine);
  return {.dimensions = dimensions,
          .capacity = capacity,
          .control = control,
          .items = kBodyOffset,
          .stride = stride,
          .bytes = round_up(kBodyOffset + capacity * stride, kPage)};
}

}  // namespace splinecast::ipc
