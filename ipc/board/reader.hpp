#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/forms/knot_segment.hpp"
#include "core/solvers/knot_ring.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/refused_item.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// What a reader saw of the commit word and of the settled word, in this order of loads: S2, R1.
struct Look {
  Time settled_until{};
  Word revision = 0;
};

/// A reader's side of a knot board, whose orderings writer.hpp argues; no function blocks,
/// allocates or stores. Every copy is taken under a revision `r` that the caller has loaded, and
/// fails if the writer has gone on too far meanwhile, or if what lies there is nothing that a
/// solver writes: whatever the bytes are, each call takes a bounded number of steps within the
/// region.
class KnotBoardReader {
 public:
  /// `region` holds a board of this layout and outlives the reader.
  KnotBoardReader(std::span<const std::byte> region, const BoardLayout& layout) noexcept;

  [[nodiscard]] std::size_t dimensions() const noexcept { return layout_.dimensions; }
  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }
  [[nodiscard]] bool smooths() const noexcept { return layout_.smooths; }

  /// S2 and R1: how far the curve is settled, and the newest revision; 0: none yet.
  [[nodiscard]] Look look() const noexcept {
    const Time settled = to_time(load(control_[kSettledUntil], std::memory_order_acquire));
    return {settled, load(control_[kRevision], std::memory_order_acquire)};
  }
  [[nodiscard]] Word revision() const noexcept {
    return load(control_[kRevision], std::memory_order_acquire);
  }
  [[nodiscard]] const Word& revision_word() const noexcept { return control_[kRevision]; }
  [[nodiscard]] bool retired() const noexcept {
    return load(control_[kRetired], std::memory_order_acquire) != 0;
  }

  /// Items consumed, which the producer may overwrite: P3.
  [[nodiscard]] Word tail() const noexcept {
    return load(control_[kTail], std::memory_order_acquire);
  }
  /// Whether the solver sleeps; seq_cst, see ring/writer.hpp.
  [[nodiscard]] bool sleeping() const noexcept {
    return load(control_[kSleeping], std::memory_order_seq_cst) != 0;
  }

  /// How many of the solver's steps took 2ⁱ to 2ⁱ⁺¹ ns, at i.
  [[nodiscard]] std::array<Word, kStepBuckets> step_times() const noexcept;

  /// Asks for the lines that a reader will load to get segment `number` of a revision that it has
  /// not seen, all at once: each may have to come from the writer's core, and would else be waited
  /// for one after the other. Loads nothing.
  void prefetch(Word r, Word number) const noexcept;

  /// Likewise for a segment anywhere: its knots' cells and nodes, of both revisions each, because
  /// the tags, which say which ones count, would else be waited for first.
  void prefetch_segment(Word number) const noexcept;

  /// Copies what lookups need of the head under a look's revision: revision, first, newest, stop,
  /// finished, settled_until; and the earliest changed_from of the revisions after `seen` up to
  /// that one, min() if that many are not kept. The other members stay, and upon failure all of
  /// them.
  [[nodiscard]] bool copy_bounds(const Look& look, Word seen, Head& out) const noexcept;

  /// Copies the whole head. Upon failure `out` stays as it is.
  [[nodiscard]] bool copy_head(const Look& look, Head& out) const noexcept;

  /// Copies the head of the newest revision, in a bounded number of tries. Returns false, and
  /// leaves `out` as it is, if there is no revision or if the writer overtook every try.
  [[nodiscard]] bool copy_newest_head(Head& out) const noexcept;

  /// Copies knot `number` under r: it must stand on the board then. Upon failure `out.tag` is 0 and
  /// the rest of no use. O(D).
  [[nodiscard]] bool copy_knot(Word number, Word r, KnotCopy& out) const noexcept;

  /// Whether a copy is what the board holds under r too: no words are copied again. K1 and K2; r is
  /// no older than the revision that the copy was made under, and the knot stands under r.
  [[nodiscard]] bool is_current(const KnotCopy& copy, Word r) const noexcept {
    return copy.tag != 0 && is_newest(cells(copy.number), copy.cell, copy.tag, r);
  }

  /// Copies waypoint `i` of a run from the slots of those that entries pass over: what lies there
  /// may be another one's, as its item says. For the one writer only, who races with nobody.
  [[nodiscard]] bool copy_passed(Word i, Word r, KnotCopy& out) const noexcept;

  /// The same where `copy` may be of another knot.
  [[nodiscard]] bool is_current(const KnotCopy& copy, Word number, Word r) const noexcept {
    return copy.number == number && is_current(copy, r);
  }

  /// Copies a knot's time and the form of the segment that begins there, under r.
  [[nodiscard]] bool copy_time(Word number, Word r, Time& time,
                               core::SegmentForm& form) const noexcept;

  /// When the segment of knot `number` begins, from the packed times: a hint, to be confirmed.
  [[nodiscard]] Time time_hint(Word number) const noexcept {
    return to_time(load(times_[number & (layout_.capacity - 1)], std::memory_order_relaxed));
  }

  /// The refusal noted at `index`, counted from 0 over the stream's life; only the last
  /// kRefusalsKept are there.
  [[nodiscard]] RefusedItem refusal(Word index) const noexcept;

  /// Copies the refusals that `head` counts from `from` on, oldest first. Returns how many there
  /// still are, at most out.size(): these are the last ones, and those before them have been
  /// overwritten.
  [[nodiscard]] std::size_t copy_refusals(const Head& head, Word from,
                                          std::span<RefusedItem> out) const noexcept;

  /// The excess noted at `index` < head.exceeding; nothing if it has been overwritten, or is
  /// being.
  [[nodiscard]] std::optional<LimitExcess> excess(const Head& head, Word index) const noexcept;

  /// That of an item, if it is one of the last kExcessesKept. O(kExcessesKept).
  [[nodiscard]] std::optional<LimitExcess> excess_of(const Head& head, Word item) const noexcept;

  /// Copies the row of a knot that has been copied, into `g`, and returns its scalars. For the one
  /// writer only, who races with nobody.
  [[nodiscard]] core::Prefix copy_row(const KnotCopy& knot, std::span<double> g) const noexcept;

 private:
  [[nodiscard]] std::size_t index_of(Word number) const noexcept {
    return number & (layout_.capacity - 1);
  }
  [[nodiscard]] const Word* slot_at(std::size_t index) const noexcept {
    return slots_.data() + index * slot_words_;
  }
  [[nodiscard]] const Word* slot(Word number) const noexcept { return slot_at(index_of(number)); }
  [[nodiscard]] bool copy_slot(std::size_t index, Word r, KnotCopy& out) const noexcept;
  [[nodiscard]] SlotView<const Word> cells(Word number) const noexcept {
    return {slot(number), cell_words_};
  }
  [[nodiscard]] SlotView<const Word> head_cells() const noexcept {
    return {control_.data() + kHeadSlot, kHeadWords};
  }
  [[nodiscard]] Time earliest_change(Word seen, Word r) const noexcept;

  BoardLayout layout_;
  std::size_t slot_words_;
  std::size_t cell_words_;
  std::span<const Word> control_;
  std::span<const Word> refusals_;
  std::span<const Word> excesses_;
  std::span<const Word> times_;
  std::span<const Word> slots_;
};

}  // namespace splinecast::ipc
