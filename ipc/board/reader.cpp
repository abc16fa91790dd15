#include "ipc/board/reader.hpp"

#include "core/forms/knot_segment.hpp"
#include "ipc/board/tag.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

/// Whether a solver can write a knot with this time: the time of a waypoint or, after the last
/// waypoint, the end of a stop segment or of an entry that returns from it.
bool is_knot_time(Time time) noexcept {
  return time >= -kLatestTime && time <= kLatestTime + 2 * kLongestStop;
}

}  // namespace

KnotBoardReader::KnotBoardReader(std::span<const std::byte> region,
                                 const BoardLayout& layout) noexcept
    : layout_(layout),
      slot_words_(layout.stride / sizeof(Word)),
      cell_words_(layout.cell / sizeof(Word)),
      control_(words_at(region, layout.control, kBoardControlWords)),
      refusals_(words_at(region, layout.refusals, kRefusalsKept)),
      excesses_(words_at(region, layout.excesses, kExcessesKept * kExcessWords)),
      worst_(words_at(region, layout.worst, kExcessWords)),
      outcomes_(words_at(region, layout.outcomes, kOutcomesKept * kOutcomeWords)),
      times_(words_at(region, layout.times, layout.capacity)),
      commanders_(layout.commanders > 0
                      ? words_at(region, layout.commanders, 2 * kCommanderTableWords)
                      : std::span<const Word>{}),
      stoppers_(words_at(region, layout.stoppers, 2 * kStopperTableWords)),
      slots_(words_at(region, layout.slots,
                      (layout.capacity + kPassedSlots) * layout.stride / sizeof(Word))) {}

std::array<Word, kStepBuckets> KnotBoardReader::step_times() const noexcept {
  std::array<Word, kStepBuckets> counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = load(control_[kStepTimes + i], std::memory_order_relaxed);
  }
  return counts;
}

void KnotBoardReader::prefetch(Word r, Word number) const noexcept {
  const auto summary = summary_cells();
  for (std::size_t c = 0; c < 2; ++c) __builtin_prefetch(summary.cell(c));
  for (const Word knot : {number, number + 1}) {
    const Word* const at = slot(knot);
    for (std::size_t c = 0; c < 2; ++c) {
      __builtin_prefetch(at + c * cell_words_);
      __builtin_prefetch(at + (layout_.nodes + c * layout_.node) / sizeof(Word));
    }
  }
  __builtin_prefetch(&control_[kChanges + r % kChangesKept]);
}

void KnotBoardReader::prefetch_segment(Word number) const noexcept {
  const std::size_t nodes_end = layout_.nodes + 2 * layout_.node;
  prefetch_lines(slot(number), nodes_end);
  prefetch_lines(slot(number + 1), nodes_end);
}

bool KnotBoardReader::copy_knot(Word number, Word r, KnotCopy& out) const noexcept {
  out.number = number;
  return copy_slot(index_of(number), r, out);
}

bool KnotBoardReader::copy_passed(Word i, Word r, KnotCopy& out) const noexcept {
  out.number = 0;
  return copy_slot(layout_.capacity + i % kPassedSlots, r, out);
}

/// Copies the knot in a slot: R2 to R4.
inline bool KnotBoardReader::copy_slot(std::size_t index, Word r, KnotCopy& out) const noexcept {
  out.tag = 0;
  const Word* const at = slot_at(index);
  const SlotView<const Word> view{at, cell_words_};
  const Tags tags = view.tags(std::memory_order_acquire);  // R2
  const std::size_t c = tags.newest(r);
  const Word tag = tags.of[c];
  if (tag == 0 || revision_of(tag) > r) return false;
  const Word* const cell = view.cell(c);
  const Word* const node = at + (layout_.nodes + node_of(tag) * layout_.node) / sizeof(Word);
  const std::size_t dimensions = layout_.dimensions;
  const auto values = std::span(out.values_);
  out.time = to_time(load(node[kNodeTime], std::memory_order_acquire));  // R3, as all below
  load_values(values.first(dimensions), node + kNodePosition);
  load_values(values.subspan(dimensions, dimensions), cell + kCellVelocity);
  out.note = note_of(tag);
  out.item = 0;
  if (out.note.arrives || out.note.starts) {
    const Word* const beside = at + (layout_.beside + c * layout_.beside_bytes) / sizeof(Word);
    out.item = load(beside[kBesideItem], std::memory_order_acquire);
    load_values(values.subspan(2 * dimensions, dimensions), beside + kBesideAcceleration);
  }
  if (layout_.smooths) {
    load_values(values.subspan(3 * dimensions, dimensions), cell + kCellVelocity + dimensions);
  }
  const bool is_valid = load(cell[kCellTag], std::memory_order_relaxed) == tag;  // R4
  if (!is_valid || static_cast<int>(out.note.form) >= core::kSegmentForms ||
      !is_knot_time(out.time)) {
    return false;
  }
  out.tag = tag;
  out.cell = c;
  out.slot = index;
  return true;
}

bool KnotBoardReader::copy_time(Word number, Word r, Time& time,
                                core::SegmentForm& form) const noexcept {
  const auto view = cells(number);
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  const Word tag = tags.of[c];
  const Word* const node =
      slot(number) + (layout_.nodes + node_of(tag) * layout_.node) / sizeof(Word);
  time = to_time(load(node[kNodeTime], std::memory_order_acquire));
  form = note_of(tag).form;
  return load(view.cell(c)[kCellTag], std::memory_order_relaxed) == tag && is_knot_time(time);
}

core::Prefix KnotBoardReader::copy_row(const KnotCopy& knot, std::span<double> g) const noexcept {
  const Word* const row =
      slot_at(knot.slot) + (layout_.rows + row_of(knot.tag) * layout_.row) / sizeof(Word);
  const auto value = [row](std::size_t i) {
    return to_double(load(row[i], std::memory_order_acquire));  // for observers: as R3
  };
  for (std::size_t d = 0; d < g.size(); ++d) g[d] = value(kRowG + d);
  core::Prefix prefix{.gamma = value(kRowGamma)};
  const std::size_t factors = kRowG + layout_.dimensions;
  if (layout_.smooths) {
    prefix.smoothing = {value(factors), value(factors + 1), value(factors + 2)};
  }
  return prefix;
}

bool KnotBoardReader::observe_row(const KnotCopy& knot, Word r, std::span<double> g,
                                  core::Prefix& prefix) const noexcept {
  prefix = copy_row(knot, g);
  // A writer stores a new tag before the row: the loads of the row are before those of the tags.
  return is_current(knot, r);
}

}  // namespace splinecast::ipc
