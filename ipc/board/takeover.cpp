#include "ipc/board/tag.hpp"
#include "ipc/board/writer.hpp"

namespace splinecast::ipc {

KnotBoardWriter::KnotBoardWriter(std::span<std::byte> region, const BoardLayout& layout)
    : layout_(layout),
      control_(words_at(region, layout.control, kBoardControlWords)),
      refusals_(words_at(region, layout.refusals, kRefusalsKept)),
      excesses_(words_at(region, layout.excesses, kExcessesKept * kExcessWords)),
      worst_(words_at(region, layout.worst, kExcessWords)),
      outcomes_(words_at(region, layout.outcomes, kOutcomesKept * kOutcomeWords)),
      times_(words_at(region, layout.times, layout.capacity)),
      commanders_(layout.commanders > 0
                      ? words_at(region, layout.commanders, 2 * kCommanderTableWords)
                      : std::span<Word>{}),
      stoppers_(words_at(region, layout.stoppers, 2 * kStopperTableWords)),
      revision_(load(control_[kRevision], std::memory_order_relaxed)),
      settled_(load(control_[kSettledUntil], std::memory_order_relaxed)),
      late_(load(control_[kLate], std::memory_order_relaxed)),
      checked_(load(control_[kChecked], std::memory_order_relaxed)),
      states_(layout.capacity + kPassedSlots),
      written_(states_.size()),
      at_{.words =
              words_at(region, layout.slots, states_.size() * layout.stride / sizeof(Word)).data(),
          .mask = layout.capacity - 1,
          .slot_words = layout.stride / sizeof(Word),
          .cell_words = layout.cell / sizeof(Word),
          .states = states_.data(),
          .written = written_.data()} {
  // Touches the memory now, so that no later step causes a page fault, for any number of knots.
  held_times_.resize(layout.capacity);
  held_times_.clear();
  retire_uncommitted(summary_cells(), revision_);
  for (std::size_t i = 0; i < states_.size(); ++i) retire_uncommitted(cells_at(i), revision_);
  read_state();
  clear_lost_records();
  restore_times();
  // A new board: no time has settled. Times may be negative, so that 0 would be a promise.
  if (revision_ == 0 && settled_ == 0) store_settled(-kLatestTime);
}

/// Loads both cells of the summary, and the state of each slot.
void KnotBoardWriter::read_state() noexcept {
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t i = 0; i < kSummaryWords; ++i) {
      summary_[c][i] = load(summary_cells().cell(c)[i], std::memory_order_relaxed);
    }
  }
  summary_cell_ = summary_cells().tags(std::memory_order_relaxed).newest(revision_);
  commanders_.take_back(summary_cell_);
  stoppers_.take_back(summary_cell_);
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Tags tags = cells_at(i).tags(std::memory_order_relaxed);
    const std::size_t c = tags.newest(revision_);
    states_[i] = static_cast<SlotState>(tags.of[c] & kTagPartsMask) | (c == 0 ? 0 : kCellBit);
  }
}

Summary KnotBoardWriter::committed_summary() const noexcept {
  Summary summary;
  decode(kSummaryRows, summary_[summary_cell_].data(), summary);
  return summary;
}

/// Restores packed times that an earlier writer stored for a revision that it did not commit: they
/// would mislead lookups as long as those knots are on the board.
void KnotBoardWriter::restore_times() noexcept {
  const Summary summary = committed_summary();
  if (summary.newest == 0 || summary.newest - summary.first >= layout_.capacity) return;
  Word begins = 0;
  for (Word number = summary.newest; number >= summary.first && number > 0; --number) {
    const std::size_t c = (states_[index_of(number)] & kCellBit) != 0 ? 1 : 0;
    const Word tag = load(cells(number).cell(c)[kCellTag], std::memory_order_relaxed);
    const Word* const node =
        slot(number) + (layout_.nodes + node_of(tag) * layout_.node) / sizeof(Word);
    const bool is_end = note_of(tag).form == core::SegmentForm::none && number < summary.newest;
    if (!is_end) begins = load(node[kNodeTime], std::memory_order_relaxed);
    Word& hint = times_[index_of(number)];
    if (load(hint, std::memory_order_relaxed) != begins) {
      store(hint, begins, std::memory_order_relaxed);
    }
  }
}

void KnotBoardWriter::discard() noexcept {
  retire_uncommitted(summary_cells(), revision_);
  stoppers_.take_back(summary_cell_);
  for (const WrittenSlot& slot : written()) {
    retire_uncommitted(cells_at(slot.index), revision_);
    states_[slot.index] &= ~kWrittenBit;
  }
  clear_lost_records();
  // In reverse order: if a time was stored twice, its first record has the committed value.
  for (std::size_t i = held_times_.size(); i-- > 0;) {
    store(times_[held_times_[i].index], held_times_[i].time, std::memory_order_relaxed);
  }
  forget_written();
}

}  // namespace splinecast::ipc
