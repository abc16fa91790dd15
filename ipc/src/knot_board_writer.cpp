#include <algorithm>
#include <bit>
#include <cmath>

#include "knot_tag.hpp"
#include "splinecast/ipc/knot_board.hpp"

namespace splinecast::ipc {
namespace {

constexpr unsigned kRefusalItemShift = 8;

/// Largest sum of magnitudes of what is kept of a knot. Values within ±core::kLargestValue at the
/// shortest intervals make none so large, and within it every segment stays within what readers
/// accept, whatever the interval.
constexpr double kLargestSum = 1e150;

/// A sum of magnitudes: at least the largest of them, and NaN if one of them is NaN. Four sums, for
/// vectors.
double magnitude(std::span<const double> values) noexcept {
  std::array<double, 4> sums{};
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::abs(values[i + k]);
  }
  for (; i < values.size(); ++i) sums[0] += std::abs(values[i]);
  return sums[0] + sums[1] + (sums[2] + sums[3]);
}

bool is_sound(const KnotRecord& knot) noexcept {
  return magnitude(knot.position) + magnitude(knot.velocity) + magnitude(knot.acceleration) +
             magnitude(knot.residual) <=
         kLargestSum;
}

}  // namespace

KnotBoardWriter::KnotBoardWriter(std::span<std::byte> region, const BoardLayout& layout)
    : layout_(layout),
      control_(words_at(region, layout.control, kBoardControlWords)),
      refusals_(words_at(region, layout.refusals, kRefusalsKept)),
      times_(words_at(region, layout.times, layout.capacity)),
      slots_(words_at(region, layout.slots, layout.capacity * layout.stride / sizeof(Word))),
      revision_(load(control_[kRevision], std::memory_order_relaxed)),
      settled_(load(control_[kSettledUntil], std::memory_order_relaxed)),
      states_(layout.capacity) {
  written_.reserve(layout.capacity);
  held_times_.reserve(layout.capacity);
  retire_uncommitted(head_cells(), revision_);
  for (Word number = 0; number < layout_.capacity; ++number) {
    retire_uncommitted(cells(number), revision_);
  }
  read_state();
  restore_times();
}

Word* KnotBoardWriter::slot(Word number) const noexcept {
  return slots_.data() + index_of(number) * (layout_.stride / sizeof(Word));
}

SlotView<Word> KnotBoardWriter::cells(Word number) const noexcept {
  return {slot(number), layout_.cell / sizeof(Word)};
}

SlotView<Word> KnotBoardWriter::head_cells() const noexcept {
  return {control_.data() + kHeadSlot, kHeadWords};
}

/// What lies on the board.
void KnotBoardWriter::read_state() noexcept {
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t i = 0; i < kHeadWords; ++i) {
      head_[c][i] = load(head_cells().cell(c)[i], std::memory_order_relaxed);
    }
  }
  head_cell_ = head_cells().tags(std::memory_order_relaxed).newest(revision_);
  for (Word number = 0; number < layout_.capacity; ++number) {
    const Tags tags = cells(number).tags(std::memory_order_relaxed);
    const std::size_t c = tags.newest(revision_);
    states_[number] = {.cell = static_cast<std::uint8_t>(c),
                       .node = static_cast<std::uint8_t>(node_of(tags.of[c])),
                       .row = static_cast<std::uint8_t>(row_of(tags.of[c]))};
  }
}

/// Packed times that a writer before this one had stored for a revision that it did not commit
/// would mislead lookups for as long as those knots stand.
void KnotBoardWriter::restore_times() noexcept {
  Head head;
  decode(kHeadRows, head_[head_cell_].data(), head);
  if (head.newest == 0 || head.newest - head.first >= layout_.capacity) return;
  Word begins = 0;
  for (Word number = head.newest; number >= head.first && number > 0; --number) {
    const SlotState state = states_[index_of(number)];
    const Word tag = load(cells(number).cell(state.cell)[kCellTag], std::memory_order_relaxed);
    const Word* const node =
        slot(number) + (layout_.nodes + state.node * layout_.node) / sizeof(Word);
    const bool is_end = note_of(tag).form == core::SegmentForm::none && number < head.newest;
    if (!is_end) begins = load(node[kNodeTime], std::memory_order_relaxed);
    Word& hint = times_[index_of(number)];
    if (load(hint, std::memory_order_relaxed) != begins) {
      store(hint, begins, std::memory_order_relaxed);
    }
  }
}

/// W1: claims the spare cell of a slot. A node or row is never stored to while a cell with a
/// standing tag names it: the committed cell names the other one, and this is the spare's.
inline Word* KnotBoardWriter::claim(std::size_t index, Word note, bool is_new,
                                    bool has_row) noexcept {
  SlotState& state = states_[index];
  if (state.is_written == 0) {
    state.is_written = 1;
    written_.push_back(static_cast<std::uint32_t>(index));
  }
  state.next_node = state.node ^ static_cast<std::uint8_t>(is_new);
  state.next_row = state.row ^ static_cast<std::uint8_t>(is_new || has_row);
  const std::size_t spare = 1U - state.cell;
  Word* const cell = slots_.data() + index * (layout_.stride / sizeof(Word)) +
                     spare * (layout_.cell / sizeof(Word));
  const Word tag = (revision_ + 1) << kTagRevisionShift | note | state.next_node |
                   static_cast<Word>(state.next_row) << kTagRowBit;
  store(cell[kCellTag], tag, std::memory_order_release);
  return cell;
}

void KnotBoardWriter::note_time(Word number, core::Time time) noexcept {
  Word& hint = times_[index_of(number)];
  held_times_.push_back({index_of(number), load(hint, std::memory_order_relaxed)});
  // A hint only: readers confirm it, so no ordering is needed.
  store(hint, to_word(time), std::memory_order_relaxed);
}

void KnotBoardWriter::write_velocity(Word number, std::uint32_t newer_knots,
                                     std::span<const double> velocity) noexcept {
  constexpr Word kNote =
      static_cast<Word>(core::SegmentForm::cubic) << kTagFormShift | Word{1} << kTagWaypointBit;
  const Word note = kNote | static_cast<Word>(newer_knots & kTagNewerMask) << kTagNewerShift;
  Word* const cell = claim(index_of(number), note, false, false);
  store_values(cell + kCellVelocity, velocity);
  double sum = 0;
  for (const double v : velocity) sum += std::abs(v);
  is_sound_ = is_sound_ && sum <= kLargestSum;
}

void KnotBoardWriter::write(Word number, const KnotRecord& knot) noexcept {
  is_sound_ = is_sound_ && ipc::is_sound(knot);
  const bool has_row = knot.prefix != nullptr;
  Word* const cell = claim(index_of(number), pack_note(knot.note), knot.is_new, has_row);
  const SlotState state = states_[index_of(number)];
  Word* const at = slot(number);
  if (knot.is_new) {
    Word* const node = at + (layout_.nodes + state.next_node * layout_.node) / sizeof(Word);
    put(node[kNodeTime], to_word(knot.time));
    store_values(node + kNodePosition, knot.position);
  }
  store_values(cell + kCellVelocity, knot.velocity);
  store_values(cell + kCellVelocity + layout_.dimensions, knot.residual);
  if (!knot.acceleration.empty()) {
    const std::size_t spare = 1 - state.cell;
    Word* const beside = at + (layout_.beside + spare * layout_.beside_bytes) / sizeof(Word);
    put(beside[kBesideItem], knot.item);
    store_values(beside + kBesideAcceleration, knot.acceleration);
  }
  const bool is_end = knot.note.form == core::SegmentForm::none;
  if (knot.is_new || is_end) note_time(number, is_end ? knot.begins : knot.time);
  if (!has_row) return;
  // Only writers read it; the lock that one takes over from the other orders their accesses.
  Word* const row = at + (layout_.rows + state.next_row * layout_.row) / sizeof(Word);
  const core::SmoothingRow& factors = knot.prefix->smoothing;
  is_sound_ = is_sound_ && std::isfinite(magnitude(knot.g) + knot.prefix->gamma);
  put(row[kRowGamma], to_word(knot.prefix->gamma));
  store_values(row + kRowG, knot.g);
  if (!layout_.smooths) return;
  const std::array<double, 3> scalars{factors.pivot, factors.lower1, factors.lower2};
  is_sound_ = is_sound_ && std::isfinite(magnitude(scalars));
  store_values(row + kRowG + layout_.dimensions, scalars);
}

void KnotBoardWriter::write_form(Word number, core::SegmentForm form, core::Time begins) noexcept {
  const SlotState before = states_[index_of(number)];
  const Word* const committed = cells(number).cell(before.cell);
  KnotNote note = note_of(load(committed[kCellTag], std::memory_order_relaxed));
  note.form = form;
  Word* const cell = claim(index_of(number), pack_note(note), false, false);
  for (std::size_t i = kCellVelocity; i < layout_.cell / sizeof(Word); ++i) {
    put(cell[i], load(committed[i], std::memory_order_relaxed));
  }
  if (note.arrives || note.starts) {
    Word* const beside = slot(number) + layout_.beside / sizeof(Word);
    const std::size_t words = layout_.beside_bytes / sizeof(Word);
    for (std::size_t i = 0; i < words; ++i) {
      put(beside[(1 - before.cell) * words + i],
          load(beside[before.cell * words + i], std::memory_order_relaxed));
    }
  }
  if (form == core::SegmentForm::none) note_time(number, begins);
}

core::SegmentForm KnotBoardWriter::form(Word number) const noexcept {
  const SlotState state = states_[index_of(number)];
  const std::size_t c = state.is_written != 0 ? 1 - state.cell : state.cell;
  return note_of(load(cells(number).cell(c)[kCellTag], std::memory_order_relaxed)).form;
}

void KnotBoardWriter::discard() noexcept {
  retire_uncommitted(head_cells(), revision_);
  for (const std::size_t index : written_) {
    retire_uncommitted(cells(index), revision_);
    states_[index].is_written = 0;
  }
  // The oldest last: a time may have been stored to twice.
  for (std::size_t i = held_times_.size(); i-- > 0;) {
    store(times_[held_times_[i].index], held_times_[i].time, std::memory_order_relaxed);
  }
  forget_written();
}

void KnotBoardWriter::forget_written() noexcept {
  written_.clear();
  held_times_.clear();
  is_sound_ = true;
}

void KnotBoardWriter::write_refusal(Word index, const RefusedItem& refusal) noexcept {
  // One word, so that it is never torn; published by the commit of the head that counts it.
  put(refusals_[index % kRefusalsKept],
      refusal.item << kRefusalItemShift | static_cast<Word>(refusal.reason));
}

void KnotBoardWriter::commit(Head& head) noexcept {
  const Word r = revision_ + 1;
  head.revision = r;
  const std::size_t spare = 1 - head_cell_;
  std::array<Word, kHeadWords>& held = head_[spare];
  std::array<Word, kHeadWords> words;
  words.fill(0);
  encode(kHeadRows, head, words.data());
  words[0] = r << kTagRevisionShift;
  Word* const cell = head_cells().cell(spare);
  store(cell[0], words[0], std::memory_order_release);                     // W1
  put(control_[kChanges + r % kChangesKept], to_word(head.changed_from));  // C1
  // What the cell holds already stands: it was stored before this revision's tag was, by this
  // writer or by one whose lock it has taken over, and whoever acquires that tag sees it.
  const auto put_changed = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (words[i] == held[i]) continue;
      held[i] = words[i];
      put(cell[i], words[i]);
    }
  };
  constexpr std::size_t kOften = 2 * kCacheLine / sizeof(Word);
  put_changed(1, kOften);
  Word differs = 0;
  for (std::size_t i = kOften; i < kHeadWords; ++i) differs |= words[i] ^ held[i];
  if (differs != 0) put_changed(kOften, kHeadWords);
  store(control_[kRevision], r, std::memory_order_release);  // W3
  revision_ = r;
  head_cell_ = spare;
  for (const std::size_t index : written_) {
    SlotState& state = states_[index];
    state.cell ^= 1;
    state.node = state.next_node;
    state.row = state.next_row;
    state.is_written = 0;
  }
  forget_written();
}

void KnotBoardWriter::count_step(core::Time length) noexcept {
  const auto ns = static_cast<Word>(std::max<std::int64_t>(length.count(), 1));
  const std::size_t bucket = std::min<std::size_t>(std::bit_width(ns) - 1, kStepBuckets - 1);
  Word& count = control_[kStepTimes + bucket];
  store(count, load(count, std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

void KnotBoardWriter::store_checked(bool is_late) noexcept {
  if (is_late) store(control_[kLate], revision_, std::memory_order_relaxed);
  store(control_[kChecked], revision_, std::memory_order_release);
}

bool KnotBoardWriter::is_checked() const noexcept {
  return load(control_[kChecked], std::memory_order_relaxed) == revision_;
}

bool KnotBoardWriter::is_late() const noexcept {
  return revision_ > 0 && load(control_[kLate], std::memory_order_relaxed) == revision_;
}

}  // namespace splinecast::ipc
