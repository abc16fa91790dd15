#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/forms/knot_segment.hpp"
#include "core/limits/check.hpp"
#include "core/solvers/knot_ring.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/outcome_record.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/board/table_cells.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// The knot board: the knots of a stream and the summary of each revision, over a span of bytes.
/// One solver writes it as publication.hpp describes; any process reads it. Knots are numbered from
/// 1; knot n is in slot n modulo the capacity. A slot does not store the number: under revision r
/// the summary says which knots are on the board, and each slot belongs to one of them.
///
/// Segment n begins at knot n. It is made from knots n and n + 1 and ends where the next segment
/// begins: at knot n + 1 or, if none begins there, at knot n + 2. So a segment that was cut keeps
/// both its knots, and the bits of its polynomial.
///
/// Orderings of the words outside the slots; those of the slots, of `settled until` and of the ring
/// of changes are publication.hpp's:
///
/// - `consumed` and `sleeping`: S3, P3 and the sleep of ring/writer.hpp. `consumed` is stored after
///   the commit: if a solver dies between the two, its items are consumed, and the next solver
///   stores `consumed` again.
/// - `late` and `checked`: stored after the commit, when it is known whether the commit was too
///   late: first `late`, if it was, then `checked`. If a writer dies before `checked`, its
///   successor decides about that revision. Others load them relaxed: each is independent.
/// - The tables of a law's commanders and of a stream's stoppers: parts of the summary's cell, as
///   W2 and R3.
/// - `holders`: stored after the commit whose table it counts, and again by a solver that takes
///   over. The producer loads it relaxed: what it appends meanwhile is refused by the solver.
/// - Packed times: relaxed. They are a hint, which a reader confirms by the knot.
/// - Step times: relaxed. Each is independent.
/// - Refusals: one word each, which is never torn, stored before W3 of the summary that counts it
///   and loaded after R1. A later refusal, committed or not, overwrites the oldest one first and
///   has a greater item number. So a word is the refusal of its index iff its item number is less
///   than that of the next index; for the last index, less than the number of items consumed under
///   that summary.
/// - Excesses: four words each. W3 of the summary that counts it and R1 order a committed one; an
///   excess of a later revision may overwrite the oldest one. The writer stores the first word as
///   0, then the other words, then the first word's value, each with release. A reader loads the
///   first word, the others (acquire), and the first word again (relaxed). If it is the same and
///   not 0, the reader has copied one whole record. It accepts the record if the summary has
///   consumed its item: a record that overwrites one that the summary counts has a later item, or
///   is recognised by its place (is_later_excess). So a first word that the reader accepts is not
///   stored twice in that place.
/// - Lost refusals and excesses, of a revision that was not committed: a takeover and a discard
///   clear them (L1), before the writer stores anything for another revision. A later revision may
///   consume their items without a refusal or an excess: then no number would distinguish them from
///   committed ones [s]. Cleared, the item number of a refusal is above all others, and the first
///   word of an excess is 0: readers reject both. No reader accepts a lost record: under a summary
///   committed before L1 its item is not consumed; a reader that sees a summary committed after L1
///   sees L1 too, by W3 and R1, or a later store to that word. L1 is a release like all stores of
///   records; relaxed would be enough, because W3 comes after it.
/// - Outcomes: as excesses, two words each, with the low byte of the index / kOutcomesKept in the
///   first word: a record of another index is not taken for it, unless 65,536 were written during
///   the reader's call. Before a record overwrites one, `outcomes lost` is raised above its item,
///   with release. A reader loads that word after the records, with acquire: if it did not find a
///   record because a newer one has overwritten it, it finds the word raised. A discarded revision
///   leaves the word too high, never too low.
/// - `retired`: stored with release and loaded with acquire; nothing but the word depends on it.
/// - The writer's loads of its own board are relaxed: the stores are its own, or those of its
///   predecessor, whose lock the kernel released when it died.
namespace splinecast::ipc {

/// The solver's side. One thread of one process uses it; no function but the constructor allocates,
/// and none blocks.
class KnotBoardWriter {
 public:
  /// `region` holds a board of this layout and outlives the writer. Retires everything that an
  /// earlier writer had not committed (T1), clears its refusals and excesses (L1), and restores the
  /// packed times of the committed knots.
  KnotBoardWriter(std::span<std::byte> region, const BoardLayout& layout);
  KnotBoardWriter(const KnotBoardWriter&) = delete;
  KnotBoardWriter& operator=(const KnotBoardWriter&) = delete;
  KnotBoardWriter(KnotBoardWriter&&) noexcept = default;
  KnotBoardWriter& operator=(KnotBoardWriter&&) noexcept = default;
  ~KnotBoardWriter() = default;

  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }

  /// The last revision that was committed.
  [[nodiscard]] Word revision() const noexcept { return revision_; }

  /// Prefetches the cache lines that a revision of knots `first` to `newest` writes, where `newest`
  /// is new.
  void prefetch(Word first, Word newest) const noexcept;

  /// Writes a knot for the next revision: each knot at most once per revision. O(D).
  void write(Word number, const KnotRecord& knot) noexcept;

  /// Writes waypoint `i` of a run to the slots of passed-over waypoints, for a solver that takes
  /// over. O(D).
  void write_passed(Word i, const KnotRecord& knot) noexcept;

  /// Writes consecutive committed knots again, from `first` on, of which only the velocities have
  /// changed: most of the work of an append. Each is a waypoint's knot at which a cubic begins.
  /// They were solved together: `newer_knots` is the number of knots newer than the first one. O(D)
  /// each.
  void write_velocities(Word first, std::uint32_t newer_knots,
                        const core::KnotVelocities& velocities) noexcept;

  /// Writes a committed knot again with another form and, if that is `none`, with the time at which
  /// the next segment begins. Nothing else changes, but the new tag shows readers that the segment
  /// has changed. O(D).
  void write_form(Word number, core::SegmentForm form, Time begins = {}) noexcept;

  /// The form of a knot's segment, as the next revision will have it.
  [[nodiscard]] core::SegmentForm form(Word number) const noexcept;

  /// Whether readers, and a solver that takes over, accept everything that was written for the next
  /// revision: finite values within bounds. Otherwise it must be discarded.
  [[nodiscard]] bool is_sound() const noexcept {
    return written_sum_ <= kLargestSum && std::isfinite(row_sum_);
  }

  /// Discards what has been written for the next revision, as a takeover does (T1, L1).
  void discard() noexcept;

  /// Writes a refusal for the next revision: the `index`-th of the stream, counted from 0.
  void write_refusal(Word index, const RefusalRecord& refusal) noexcept;

  /// Writes the place where a limit was exceeded: the `index`-th excess of the stream, counted from
  /// 0.
  void write_excess(Word index, const LimitExcess& excess) noexcept;

  /// Writes the largest excess of a waypoint that was not refused, for all revisions from now on.
  void write_worst_excess(const LimitExcess& excess) noexcept;

  /// Writes record `index`, counted from 0, of the stream's outcomes for the next revision.
  void write_outcome(Word index, const OutcomeRecord& record) noexcept;

  /// Records that the outcomes of items before `end` may be lost: of a solver that has died.
  void lose_outcomes(Word end) noexcept;

  /// Sets the table of a law's commanders for the next revision: kCommanderTableWords words, or
  /// none to leave it as it is. Only for the board of a law.
  void set_commanders(std::span<const Word> table) noexcept;

  /// Sets the table of the stream's stoppers for the next revision: kStopperTableWords words. The
  /// last one that was set, or that an earlier writer committed, is next_stoppers().
  void set_stoppers(std::span<const Word> table) noexcept { stoppers_.set(table); }
  [[nodiscard]] std::span<const Word> next_stoppers() const noexcept { return stoppers_.next(); }

  /// Stores how many stoppers hold the stream, for the producer.
  void store_holders(Word holders) noexcept {
    store(control_[kHolders], holders, std::memory_order_relaxed);
  }

  /// Makes everything written visible, as the next revision: W3. Sets summary.revision.
  void commit(Summary& summary) noexcept;

  /// Promises that no later revision changes anything before t: S1. Stores nothing if t has already
  /// been promised.
  void store_settled(Time t) noexcept {
    const Word word = to_word(t);
    if (word == settled_) return;
    settled_ = word;
    store(control_[kSettledUntil], word, std::memory_order_release);
  }

  /// Takes back a promise that no process can have used: see StreamSolver. The next load of this
  /// thread comes after the store.
  void lower_settled(Time t) noexcept {
    settled_ = to_word(t);
    store(control_[kSettledUntil], settled_, std::memory_order_seq_cst);
  }

  /// The settled word itself, for SettledRaise.
  [[nodiscard]] Word& settled_word() noexcept { return control_[kSettledUntil]; }

  /// Loads the settled word, which a SettledRaise may have raised.
  [[nodiscard]] Time resume_settled() noexcept {
    settled_ = load(control_[kSettledUntil], std::memory_order_relaxed);
    return to_time(settled_);
  }

  /// Releases items to the producer, after the commit that consumed them: S3.
  void store_consumed(Word consumed) noexcept {
    store(control_[kConsumed], consumed, std::memory_order_release);
  }

  /// Counts a step of this length in the histogram.
  void count_step(Time length) noexcept;

  /// Records, after the commit, that the newest revision was compared with the clock, and whether
  /// it was too late.
  void store_checked(bool is_late) noexcept;

  /// Whether the newest revision has been compared with the clock, and whether it was too late.
  [[nodiscard]] bool is_checked() const noexcept { return checked_ == revision_; }
  [[nodiscard]] bool is_late() const noexcept { return revision_ > 0 && late_ == revision_; }

  /// Stores whether the solver is about to sleep, or is awake again: seq_cst, see ring/writer.hpp.
  void store_sleeping(bool sleeping) noexcept {
    store(control_[kSleeping], sleeping ? 1 : 0, std::memory_order_seq_cst);
  }

  /// Keeps the position at which the board that this one replaces came to rest, for a producer: see
  /// OldEnd. It is in the first node of slot 0, which no knot uses before knot `capacity`. Call it
  /// before the region has a name: then each process that opens the region finds it, and nothing
  /// changes it while the board has no knot.
  void write_old_end(std::span<const double> position) noexcept;

  /// Marks the region as retired.
  void retire() noexcept { store(control_[kRetired], 1, std::memory_order_release); }

  /// The word that readers wait on.
  [[nodiscard]] const Word& revision_word() const noexcept { return control_[kRevision]; }

 private:
  /// Largest sum of the magnitudes of everything that one revision writes. Values within
  /// ±kLargestValue stay below it, even at the shortest intervals. Below it, readers accept every
  /// segment, for any interval.
  static constexpr double kLargestSum = 1e150;

  /// The writer's own record of a slot: the node and row bits of the newest committed cell's tag;
  /// kCellBit if that cell is cell 1; kWrittenBit if the slot has been written for the next
  /// revision.
  using SlotState = std::uint32_t;
  static constexpr SlotState kCellBit = 1U << 16;
  static constexpr SlotState kWrittenBit = 1U << 17;

  /// A slot that has been written for the next revision, and its state after that revision's
  /// commit.
  struct WrittenSlot {
    std::uint32_t index;
    SlotState next;
  };

  /// The slots, and the writer's records of them.
  struct Slots {
    Word* words;
    std::size_t mask;
    std::size_t slot_words;
    std::size_t cell_words;
    SlotState* states;
    WrittenSlot* written;           ///< each slot at most once
    std::size_t written_count = 0;  ///< at most the number of slots

    [[nodiscard]] Word* slot(std::size_t index) const noexcept {
      return words + index * slot_words;
    }
  };

  /// A slot whose spare cell has been claimed for the next revision.
  struct Claimed {
    Word* slot;
    Word* cell;
    SlotState next;

    /// Which of the two cells is written: 0 or 1.
    [[nodiscard]] std::size_t which_cell() const noexcept { return (next & kCellBit) != 0 ? 1 : 0; }
  };
  /// A packed time that has been overwritten for the next revision, and its previous value.
  struct HeldTime {
    std::size_t index;
    Word time;
  };

  [[nodiscard]] std::size_t index_of(Word number) const noexcept { return number & at_.mask; }
  [[nodiscard]] Word* slot(Word number) const noexcept { return at_.slot(index_of(number)); }
  [[nodiscard]] SlotView<Word> cells_at(std::size_t index) const noexcept {
    return {at_.slot(index), at_.cell_words};
  }
  [[nodiscard]] SlotView<Word> cells(Word number) const noexcept {
    return cells_at(index_of(number));
  }
  [[nodiscard]] SlotView<Word> summary_cells() const noexcept {
    return {control_.data() + kSummarySlot, kSummaryWords};
  }
  [[nodiscard]] static Claimed claim(Slots& slots, std::size_t index, Word tag,
                                     SlotState changed) noexcept;
  void write_slot(std::size_t index, const KnotRecord& knot) noexcept;
  [[nodiscard]] static WrittenSlot& written_slot(const Slots& slots, std::size_t index) noexcept;
  [[nodiscard]] Word next_tag() const noexcept { return (revision_ + 1) << kTagRevisionShift; }
  [[nodiscard]] std::span<const WrittenSlot> written() const noexcept {
    return std::span(written_).first(at_.written_count);
  }
  void note_time(Word number, Time time) noexcept;
  void read_state() noexcept;
  [[nodiscard]] Summary committed_summary() const noexcept;
  void clear_lost_records() noexcept;
  void restore_times() noexcept;
  void forget_written() noexcept {
    at_.written_count = 0;
    held_times_.clear();
    written_sum_ = 0;
    row_sum_ = 0;
  }

  BoardLayout layout_;
  std::span<Word> control_;
  std::span<Word> refusals_;
  std::span<Word> excesses_;
  std::span<Word> worst_;
  std::span<Word> outcomes_;
  std::span<Word> times_;
  TableCells commanders_;  ///< of a law
  TableCells stoppers_;
  Word revision_;
  Word settled_;
  Word late_;
  Word checked_;
  std::size_t summary_cell_ = 0;                              ///< of the newest committed summary
  std::array<std::array<Word, kSummaryWords>, 2> summary_{};  ///< what both cells hold
  std::vector<SlotState> states_;
  std::vector<WrittenSlot> written_;
  Slots at_;  ///< views of the region and of the two vectors
  std::vector<HeldTime> held_times_;
  double written_sum_ = 0;  ///< of the magnitudes that readers see of the next revision
  double row_sum_ = 0;      ///< of the magnitudes of its rows
};

}  // namespace splinecast::ipc
