#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/forms/knot_segment.hpp"
#include "core/solvers/knot_ring.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/outcome_record.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Values of the settled word and the commit word, loaded in this order: S2, R1.
struct Look {
  Time settled_until{};
  Word revision = 0;
};

/// The reading side of a knot board; writer.hpp explains the orderings. No function blocks,
/// allocates or stores. Every copy is made under a revision `r` that the caller has loaded. A copy
/// fails if the writer has advanced too far meanwhile, or if the data is not what a solver writes.
/// For any content of the region, each call takes a bounded number of steps and stays within the
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
  [[nodiscard]] Word consumed() const noexcept {
    return load(control_[kConsumed], std::memory_order_acquire);
  }
  /// Whether the solver sleeps; seq_cst, see ring/writer.hpp.
  [[nodiscard]] bool sleeping() const noexcept {
    return load(control_[kSleeping], std::memory_order_seq_cst) != 0;
  }

  /// Histogram of the solver's steps: element i counts those of 2ⁱ to 2ⁱ⁺¹ ns.
  [[nodiscard]] std::array<Word, kStepBuckets> step_times() const noexcept;

  /// Prefetches the cache lines that a reader will load for segment `number` under revision r,
  /// which it has not seen yet. Each line may have to come from the writer's core; without the
  /// prefetch, the loads would wait for one line after the other. Loads nothing.
  void prefetch(Word r, Word number) const noexcept;

  /// Prefetches the cache lines of a segment anywhere on the board: both cells and both nodes of
  /// its knots, because the tags, which select the valid ones, have not been loaded yet. Loads
  /// nothing.
  void prefetch_segment(Word number) const noexcept;

  /// Copies the values of the summary that lookups need, under the revision of `look`: revision,
  /// first, newest, stop, finished, settled_until; and changed_from, the earliest of the revisions
  /// after `seen` up to that one, min() if some of these are no longer kept. The other members do
  /// not change; on failure none changes.
  [[nodiscard]] bool copy_bounds(const Look& look, Word seen, Summary& out) const noexcept;

  /// Until when the solver refuses waypoints as `cannot follow`, under revision r; max() if it does
  /// not, or if the writer overtook this call. O(1).
  [[nodiscard]] Time refused_until(Word r) const noexcept;

  /// Copies the whole summary. On failure `out` does not change.
  [[nodiscard]] bool copy_summary(const Look& look, Summary& out) const noexcept;

  /// Copies the summary of the newest revision, in a bounded number of tries. Returns false,
  /// without changing `out`, if there is no revision or if the writer overtook every try.
  [[nodiscard]] bool copy_newest_summary(Summary& out) const noexcept;

  /// Copies the table of a law's commanders of the newest revision, in a bounded number of tries.
  /// Returns false if there is no revision, if the writer overtook every try, or on the board of
  /// another stream; then `out` is not valid.
  [[nodiscard]] bool copy_commanders(std::span<Word, kCommanderTableWords> out) const noexcept {
    return copy_table(commanders_, out);
  }

  /// The same for the table of the stream's stoppers, which each board has.
  [[nodiscard]] bool copy_stoppers(std::span<Word, kStopperTableWords> out) const noexcept {
    return copy_table(stoppers_, out);
  }

  /// How many stoppers hold the stream.
  [[nodiscard]] Word holders() const noexcept {
    return load(control_[kHolders], std::memory_order_relaxed);
  }

  /// Copies knot `number`, which must be on the board under r. On failure `out.tag` is 0 and the
  /// rest is not valid. O(D).
  [[nodiscard]] bool copy_knot(Word number, Word r, KnotCopy& out) const noexcept;

  /// Whether a copy is also what the board holds under r, without copying again: K1 and K2. r must
  /// be the revision of the copy or a later one, and the knot must be on the board under r.
  [[nodiscard]] bool is_current(const KnotCopy& copy, Word r) const noexcept {
    return copy.tag != 0 && is_newest(cells(copy.number), copy.cell, copy.tag, r);
  }

  /// Copies waypoint `i` of a run from the slots of passed-over waypoints. The slot may hold
  /// another waypoint: compare the copy's item. Only the writer calls it, so that no other process
  /// writes concurrently.
  [[nodiscard]] bool copy_passed(Word i, Word r, KnotCopy& out) const noexcept;

  /// is_current() for a copy that may be of another knot.
  [[nodiscard]] bool is_current(const KnotCopy& copy, Word number, Word r) const noexcept {
    return copy.number == number && is_current(copy, r);
  }

  /// Copies a knot's time, and the form of the segment that begins there, under r. On failure both
  /// are not valid.
  [[nodiscard]] bool copy_time(Word number, Word r, Time& time,
                               core::SegmentForm& form) const noexcept;

  /// Whether the board keeps the position at which the board before it came to rest, and a copy of
  /// it, if so. Only for a board without knots. `position` has D values, which are not checked.
  [[nodiscard]] bool has_old_end() const noexcept;
  [[nodiscard]] bool copy_old_end(std::span<double> position) const noexcept;

  /// The time at which the segment of knot `number` begins, from the packed times. This is a hint:
  /// confirm it by the knot.
  [[nodiscard]] Time time_hint(Word number) const noexcept {
    return to_time(load(times_[number & (layout_.capacity - 1)], std::memory_order_relaxed));
  }

  /// Refusal number `index`, counted from 0 over the stream's life. The board has only the last
  /// kRefusalsKept: for an older index, the result is a later refusal.
  [[nodiscard]] RefusalRecord refusal(Word index) const noexcept;

  /// Copies refusals that `summary` counts, from number `from` on, oldest first: the newest ones
  /// that fit into `out` and have not been overwritten. Returns how many.
  [[nodiscard]] std::size_t copy_refusals(const Summary& summary, Word from,
                                          std::span<RefusalRecord> out) const noexcept;

  /// Excess number `index` < summary.exceeding; empty if it has been, or is being, overwritten.
  [[nodiscard]] std::optional<LimitExcess> excess(const Summary& summary,
                                                  Word index) const noexcept;

  /// The largest excess of a waypoint that was not refused, or of a stop that the curve has begun;
  /// empty before the first excess, and while one is being written. It may belong to the next
  /// revision, or to one that was discarded.
  [[nodiscard]] std::optional<LimitExcess> worst_excess() const noexcept;

  /// The excess of an item, if it is one of the last kExcessesKept. O(kExcessesKept).
  [[nodiscard]] std::optional<LimitExcess> excess_of(const Summary& summary,
                                                     Word item) const noexcept;

  /// Record `index` < summary.outcomes of the stream's outcomes; empty if it has been, or is being,
  /// overwritten.
  [[nodiscard]] std::optional<OutcomeRecord> outcome(Word index) const noexcept;

  /// Items below this may have had an outcome whose record is lost. Load it after the records.
  [[nodiscard]] Word outcomes_lost() const noexcept {
    return load(control_[kOutcomesLost], std::memory_order_acquire);
  }

  /// Copies the right side of the row of a copied knot into `g`, and returns the row's scalars.
  /// For the writer, so that no other process writes concurrently; others call observe_row().
  [[nodiscard]] core::Prefix copy_row(const KnotCopy& knot, std::span<double> g) const noexcept;

  /// Copies the row of a knot that was copied under revision r, for an observer. Returns false if
  /// the row has been, or may have been, overwritten. Only the row of a knot that has settled and
  /// has a newer knot is final. O(D).
  [[nodiscard]] bool observe_row(const KnotCopy& knot, Word r, std::span<double> g,
                                 core::Prefix& prefix) const noexcept;

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
  [[nodiscard]] SlotView<const Word> summary_cells() const noexcept {
    return {control_.data() + kSummarySlot, kSummaryWords};
  }
  [[nodiscard]] bool copy_table(std::span<const Word> tables, std::span<Word> out) const noexcept;
  [[nodiscard]] Time earliest_change(Word seen, Word r) const noexcept;

  BoardLayout layout_;
  std::size_t slot_words_;
  std::size_t cell_words_;
  std::span<const Word> control_;
  std::span<const Word> refusals_;
  std::span<const Word> excesses_;
  std::span<const Word> worst_;
  std::span<const Word> outcomes_;
  std::span<const Word> times_;
  std::span<const Word> commanders_;  ///< of a law: both tables of commanders
  std::span<const Word> stoppers_;    ///< both tables of stoppers
  std::span<const Word> slots_;
};

}  // namespace splinecast::ipc
