#include "ipc/layout/knot_slots.hpp"

#include <span>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

BoardLayout BoardLayout::of(std::size_t dimensions, std::size_t capacity, std::size_t control,
                            bool smooths, bool is_law) noexcept {
  // Only `smoothing` has the last field of a cell and of a row.
  const auto lines = [&](std::span<const Field> fields) {
    const Extent size = smooths ? size_of(fields) : fields.back().offset;
    return round_up(size.of(dimensions) * sizeof(Word), kCacheLine);
  };
  BoardLayout layout{
      .dimensions = dimensions,
      .capacity = capacity,
      .control = control,
      .smooths = smooths,
      .refusals = kBodyOffset,
      .excesses = kBodyOffset + word_of(kBodyFields, "excesses") * sizeof(Word),
      .worst = kBodyOffset + word_of(kBodyFields, "worst excess") * sizeof(Word),
      .outcomes = kBodyOffset + word_of(kBodyFields, "outcomes") * sizeof(Word),
      .stoppers = kBodyOffset + word_of(kBodyFields, "stoppers") * sizeof(Word),
      .times = kBodyOffset + word_of(kBodyFields, "times") * sizeof(Word),
      .slots = 0,
      .cell = lines(kCellFields),
      .nodes = 0,
      .node = round_up(size_of(kNodeFields).of(dimensions) * sizeof(Word), kCacheLine),
      .beside = 0,
      .beside_bytes = round_up(size_of(kBesideFields).of(dimensions) * sizeof(Word), kCacheLine),
      .rows = 0,
      .row = lines(kRowFields),
      .stride = 0,
      .commanders = 0,
      .bytes = 0};
  layout.slots = round_up(layout.times + capacity * sizeof(Word), kPage);
  layout.nodes = 2 * layout.cell;
  layout.beside = layout.nodes + 2 * layout.node;
  layout.rows = layout.beside + 2 * layout.beside_bytes;
  layout.stride = layout.rows + 2 * layout.row;
  layout.bytes = round_up(layout.slots + (capacity + kPassedSlots) * layout.stride, kPage);
  if (!is_law) return layout;
  layout.commanders = layout.bytes;
  layout.bytes = round_up(layout.bytes + 2 * kCommanderTableWords * sizeof(Word), kPage);
  return layout;
}

}  // namespace splinecast::ipc
