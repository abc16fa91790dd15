#include "ipc/board/writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/basics/magnitude.hpp"
#include "ipc/board/tag.hpp"
#include "ipc/memory/separation.hpp"

namespace splinecast::ipc {

/// The record of a slot that has been written for the next revision.
KnotBoardWriter::WrittenSlot& KnotBoardWriter::written_slot(const Slots& slots,
                                                            std::size_t index) noexcept {
  std::size_t i = slots.written_count - 1;
  while (slots.written[i].index != index) --i;
  return slots.written[i];
}

/// W1: claims the spare cell of a slot by storing its tag. No node or row is overwritten while a
/// cell with a valid tag names it: the committed cell names the other one, and the old tag of the
/// spare cell is overwritten here. `changed` has the bit of the node, and of the row, if the
/// revision writes a new one.
inline KnotBoardWriter::Claimed KnotBoardWriter::claim(Slots& slots, std::size_t index, Word tag,
                                                       SlotState changed) noexcept {
  const SlotState state = slots.states[index];
  const SlotState next = (state & ~kWrittenBit) ^ (kCellBit | changed);
  slots.states[index] = state | kWrittenBit;
  const bool is_written = (state & kWrittenBit) != 0;
  WrittenSlot& written =
      is_written ? written_slot(slots, index) : slots.written[slots.written_count++];
  written = {static_cast<std::uint32_t>(index), next};
  Word* const slot = slots.slot(index);
  Word* const cell = (next & kCellBit) != 0 ? slot + slots.cell_words : slot;
  store(cell[kCellTag], tag | (next & kTagPartsMask), std::memory_order_release);
  return {slot, cell, next};
}

void KnotBoardWriter::prefetch(Word first, Word newest) const noexcept {
  const std::size_t cell_bytes = layout_.cell;
  for (Word number = first; number <= newest; ++number) {
    const std::size_t index = index_of(number);
    const std::size_t spare = (states_[index] & kCellBit) != 0 ? 0 : at_.cell_words;
    const Word* const cell = at_.slot(index) + spare;
    for (std::size_t at = 0; at < cell_bytes; at += kCacheLine) {
      __builtin_prefetch(cell + at / sizeof(Word), 1);
    }
  }
  const Word* const slot = at_.slot(index_of(newest));
  prefetch_lines(slot + layout_.nodes / sizeof(Word), layout_.stride - layout_.nodes);
  __builtin_prefetch(&times_[index_of(newest)], 1);
  const Word* const summary = summary_cells().cell(1 - summary_cell_);
  __builtin_prefetch(summary, 1);
  __builtin_prefetch(summary + kCacheLine / sizeof(Word), 1);
  __builtin_prefetch(&control_[kRevision], 1);
  __builtin_prefetch(&control_[kConsumed], 1);
  __builtin_prefetch(&control_[kChanges + (revision_ + 1) % kChangesKept], 1);
  __builtin_prefetch(written_.data(), 1);
  __builtin_prefetch(held_times_.data(), 1);
}

void KnotBoardWriter::note_time(Word number, Time time) noexcept {
  Word& hint = times_[index_of(number)];
  held_times_.push_back({index_of(number), load(hint, std::memory_order_relaxed)});
  // A hint only: readers confirm it, so no ordering is needed.
  store(hint, to_word(time), std::memory_order_relaxed);
}

void KnotBoardWriter::write_velocities(Word first, std::uint32_t newer_knots,
                                       const core::KnotVelocities& velocities) noexcept {
  constexpr Word kNote =
      static_cast<Word>(core::SegmentForm::cubic) << kTagFormShift | Word{1} << kTagWaypointBit;
  const Word tag = next_tag() | kNote;
  const std::size_t dimensions = layout_.dimensions;
  const double* values = velocities.values;
  // A copy: otherwise the compiler loads these members again after each store to shared memory.
  Slots slots = at_;
  for (std::size_t i = 0; i < velocities.count; ++i, values += velocities.stride) {
    const Word newer = (newer_knots - i) & kTagNewerMask;
    const Claimed claimed =
        claim(slots, (first + i) & slots.mask, tag | newer << kTagNewerShift, 0);
    store_values(claimed.cell + kCellVelocity, {values, dimensions});
  }
  at_.written_count = slots.written_count;
  written_sum_ += core::magnitude_of({velocities.values, velocities.count * velocities.stride});
}

void KnotBoardWriter::write(Word number, const KnotRecord& knot) noexcept {
  write_slot(index_of(number), knot);
  const bool is_end = knot.note.form == core::SegmentForm::none;
  if (knot.is_new || is_end) note_time(number, is_end ? knot.begins : knot.time);
}

void KnotBoardWriter::write_passed(Word i, const KnotRecord& knot) noexcept {
  write_slot(layout_.capacity + i % kPassedSlots, knot);
}

inline void KnotBoardWriter::write_slot(std::size_t index, const KnotRecord& knot) noexcept {
  double sum = 0;
  const bool has_row = knot.prefix != nullptr;
  const auto changed = static_cast<SlotState>((knot.is_new ? kTagNodeMask : 0) |
                                              (knot.is_new || has_row ? kTagRowMask : 0));
  const Claimed claimed = claim(at_, index, next_tag() | pack_note(knot.note), changed);
  if (knot.is_new) {
    Word* const node =
        claimed.slot + (layout_.nodes + node_of(claimed.next) * layout_.node) / sizeof(Word);
    put(node[kNodeTime], to_word(knot.time));
    store_summed(node + kNodePosition, knot.position, sum);
  }
  store_summed(claimed.cell + kCellVelocity, knot.velocity, sum);
  if (!knot.residual.empty()) {
    store_summed(claimed.cell + kCellVelocity + layout_.dimensions, knot.residual, sum);
  }
  if (!knot.acceleration.empty()) {
    Word* const beside =
        claimed.slot +
        (layout_.beside + claimed.which_cell() * layout_.beside_bytes) / sizeof(Word);
    put(beside[kBesideItem], knot.item);
    store_summed(beside + kBesideAcceleration, knot.acceleration, sum);
  }
  written_sum_ += sum;
  if (!has_row) return;
  // This writer and its successors read the row: the lock that passes from one to the next orders
  // their accesses. Observers copy it too, and then check the tags: each word is stored with
  // release, after W1 of this revision, as a word of a node.
  Word* const row =
      claimed.slot + (layout_.rows + row_of(claimed.next) * layout_.row) / sizeof(Word);
  put(row[kRowGamma], to_word(knot.prefix->gamma));
  double row_sum = std::abs(knot.prefix->gamma);
  store_summed(row + kRowG, knot.g, row_sum);
  if (layout_.smooths) {
    const core::SmoothingRow& factors = knot.prefix->smoothing;
    const std::array scalars{factors.pivot, factors.lower1, factors.lower2};
    store_summed(row + kRowG + layout_.dimensions, scalars, row_sum);
  }
  row_sum_ += row_sum;
}

void KnotBoardWriter::write_form(Word number, core::SegmentForm form, Time begins) noexcept {
  const std::size_t c = (states_[index_of(number)] & kCellBit) != 0 ? 1 : 0;
  const Word* const committed = cells(number).cell(c);
  KnotNote note = note_of(load(committed[kCellTag], std::memory_order_relaxed));
  note.form = form;
  const Claimed claimed = claim(at_, index_of(number), next_tag() | pack_note(note), 0);
  for (std::size_t i = kCellVelocity; i < at_.cell_words; ++i) {
    put(claimed.cell[i], load(committed[i], std::memory_order_relaxed));
  }
  if (note.arrives || note.starts) {
    Word* const beside = claimed.slot + layout_.beside / sizeof(Word);
    const std::size_t words = layout_.beside_bytes / sizeof(Word);
    for (std::size_t i = 0; i < words; ++i) {
      put(beside[claimed.which_cell() * words + i],
          load(beside[c * words + i], std::memory_order_relaxed));
    }
  }
  if (form == core::SegmentForm::none) note_time(number, begins);
}

core::SegmentForm KnotBoardWriter::form(Word number) const noexcept {
  const SlotState committed = states_[index_of(number)];
  const SlotState state =
      (committed & kWrittenBit) != 0 ? written_slot(at_, index_of(number)).next : committed;
  const std::size_t c = (state & kCellBit) != 0 ? 1 : 0;
  return note_of(load(cells(number).cell(c)[kCellTag], std::memory_order_relaxed)).form;
}

void KnotBoardWriter::set_commanders(std::span<const Word> table) noexcept {
  if (table.empty()) return commanders_.take_back(summary_cell_);
  commanders_.set(table);
}

void KnotBoardWriter::commit(Summary& summary) noexcept {
  const Word r = revision_ + 1;
  summary.revision = r;
  const std::size_t spare = 1 - summary_cell_;
  std::array<Word, kSummaryWords>& held = summary_[spare];
  Word* const cell = summary_cells().cell(spare);
  held[0] = r << kTagRevisionShift;
  store(cell[0], held[0], std::memory_order_release);                         // W1
  put(control_[kChanges + r % kChangesKept], to_word(summary.changed_from));  // C1
  // Words that the cell already holds are not stored: this writer, or one whose lock it has taken
  // over, stored them before this revision's tag, and a reader that acquires that tag sees them.
  encode_changes(kSummaryRows, summary, held.data(),
                 [cell](std::size_t i, Word word) { put(cell[i], word); });
  if (!commanders_.empty()) commanders_.write(spare);
  stoppers_.write(spare);
  store(control_[kRevision], r, std::memory_order_release);  // W3
  revision_ = r;
  summary_cell_ = spare;
  for (const WrittenSlot& slot : written()) states_[slot.index] = slot.next;
  forget_written();
}

void KnotBoardWriter::store_checked(bool is_late) noexcept {
  if (is_late) {
    late_ = revision_;
    store(control_[kLate], revision_, std::memory_order_relaxed);
  }
  checked_ = revision_;
  store(control_[kChecked], revision_, std::memory_order_release);
}

void KnotBoardWriter::count_step(Time length) noexcept {
  const auto ns = static_cast<Word>(std::max<std::int64_t>(length.count(), 1));
  const std::size_t bucket = std::min<std::size_t>(std::bit_width(ns) - 1, kStepBuckets - 1);
  Word& count = control_[kStepTimes + bucket];
  store(count, load(count, std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace splinecast::ipc
