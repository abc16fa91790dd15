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
#include "ipc/board/refused_item.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// The knot board: the knots of a stream and the head that goes with each revision, over a span of
/// bytes. One solver writes it, by publication.hpp; anybody reads. Knots are numbered from 1; knot
/// n lies in slot n modulo the capacity, and there is no number in the slot: under revision r the
/// head says which knots stand, and each slot belongs to one of them.
///
/// Segment n begins at knot n. It is made from knots n and n + 1 and ends where the next segment
/// begins: at knot n + 1, or, where that knot is one at which none begins, at the one behind it. So
/// a segment that was cut keeps both its knots, and its bits.
///
/// Orderings of the words outside the slots; those of the slots, of `settled until` and of the ring
/// of changes are publication.hpp's:
///
/// - `tail` and `sleeping`: S3, P3 and the sleep of ring/writer.hpp. `tail` follows the commit,
///   so that a solver that dies between the two has its items consumed: the next one stores it
///   again.
/// - `late` and `checked`, which are stored after the commit, when it is known whether it came too
///   late: first `late`, if it did, then `checked`. If a writer dies before `checked`, its
///   successor decides about that revision. Others load them relaxed: each is a number of its own.
/// - Packed times: relaxed. They are a hint; the knot that they lead to decides.
/// - Step times: relaxed. Each is a number of its own.
/// - Refusals: one word each, which is never torn, stored before W3 of the head that counts it and
///   loaded after R1. A later refusal, committed or not, overwrites the oldest one first; it is of
///   a later item. So a word is the refusal of its index iff its item comes before that of the next
///   index; the last one's item must come before the first item not consumed under that head.
/// - Excesses: four words. W3 of the head that counts it and R1 order a committed one; that of a
///   later revision may overwrite the oldest. Its first word is stored as 0 before the others, each
///   of which is a release, and last as what it is, so that who loads with acquire the same first
///   word before and after the others, and not 0, has copied one whole record: items are never
///   given twice.
/// - `retired`: stored with release and loaded with acquire; nothing depends on more than the word.
/// - What the writer loads of its own board is relaxed: it made these stores itself, or its
///   predecessor did, whose death the kernel told by giving the owner's lock away.
namespace splinecast::ipc {

/// The solver's side. One thread of one process uses it; no function but the constructor allocates,
/// and none blocks.
class KnotBoardWriter {
 public:
  /// `region` holds a board of this layout and outlives the writer. Retires whatever a writer
  /// before this one had not committed (T1), and makes the packed times those of the committed
  /// knots again.
  KnotBoardWriter(std::span<std::byte> region, const BoardLayout& layout);
  KnotBoardWriter(const KnotBoardWriter&) = delete;
  KnotBoardWriter& operator=(const KnotBoardWriter&) = delete;
  KnotBoardWriter(KnotBoardWriter&&) noexcept = default;
  KnotBoardWriter& operator=(KnotBoardWriter&&) noexcept = default;
  ~KnotBoardWriter() = default;

  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }

  /// The last revision that was committed.
  [[nodiscard]] Word revision() const noexcept { return revision_; }

  /// Asks for the lines that a revision of knots `first` to `newest` writes, where `newest` is new.
  void prefetch(Word first, Word newest) const noexcept;

  /// Writes a knot for the next revision: at most once each. O(D).
  void write(Word number, const KnotRecord& knot) noexcept;

  /// Writes waypoint `i` of a run, which an entry passes over, for a solver that takes over. O(D).
  void write_passed(Word i, const KnotRecord& knot) noexcept;

  /// Writes consecutive committed knots again, from `first` on, of which only the velocities have
  /// changed: most of what an append does. At each of them stands a waypoint, and a cubic begins.
  /// They were solved together: `newer_knots` is how many newer knots the first one had seen. O(D)
  /// each.
  void write_velocities(Word first, std::uint32_t newer_knots,
                        const core::KnotVelocities& velocities) noexcept;

  /// Writes a committed knot again with another form, and, where that is `none`, with the time at
  /// which the next segment begins. Else nothing changes; readers see that its segment has. O(D).
  void write_form(Word number, core::SegmentForm form, Time begins = {}) noexcept;

  /// The form of a knot's segment, as the next revision will have it.
  [[nodiscard]] core::SegmentForm form(Word number) const noexcept;

  /// Whether all that was written for the next revision is what readers, and a solver that takes
  /// over, accept: finite values within bounds. Else it must be discarded.
  [[nodiscard]] bool is_sound() const noexcept {
    return written_sum_ <= kLargestSum && std::isfinite(row_sum_);
  }

  /// Takes back what has been written for the next revision, as a takeover does (T1).
  void discard() noexcept;

  /// Notes a refusal for the next revision: the `index`-th of the stream, counted from 0.
  void write_refusal(Word index, const RefusedItem& refusal) noexcept;

  /// Notes where a limit was passed: the `index`-th time in the stream, counted from 0.
  void write_excess(Word index, const LimitExcess& excess) noexcept;

  /// Makes what has been written visible, as the revision after the last one: W3. Sets
  /// head.revision.
  void commit(Head& head) noexcept;

  /// Promises that no later revision changes anything before t: S1. Stores nothing where that has
  /// been said already.
  void store_settled(Time t) noexcept {
    const Word word = to_word(t);
    if (word == settled_) return;
    settled_ = word;
    store(control_[kSettledUntil], word, std::memory_order_release);
  }

  /// The settled word itself, for SettledRaise.
  [[nodiscard]] Word& settled_word() noexcept { return control_[kSettledUntil]; }

  /// Loads the settled word, which a SettledRaise may have raised.
  [[nodiscard]] Time take_up_settled() noexcept {
    settled_ = load(control_[kSettledUntil], std::memory_order_relaxed);
    return to_time(settled_);
  }

  /// Items that the producer may overwrite: after the commit that consumed them, S3.
  void store_tail(Word consumed) noexcept {
    store(control_[kTail], consumed, std::memory_order_release);
  }

  /// Counts a step of so many nanoseconds.
  void count_step(Time length) noexcept;

  /// Notes, behind the commit, that the newest revision was compared with the clock, and whether it
  /// came too late.
  void store_checked(bool is_late) noexcept;

  /// Whether the newest revision has been compared so, and whether it was found to be too late.
  [[nodiscard]] bool is_checked() const noexcept { return checked_ == revision_; }
  [[nodiscard]] bool is_late() const noexcept { return revision_ > 0 && late_ == revision_; }

  /// For a solver about to sleep, or awake again: seq_cst, see ring/writer.hpp.
  void store_sleeping(bool sleeping) noexcept {
    store(control_[kSleeping], sleeping ? 1 : 0, std::memory_order_seq_cst);
  }

  /// Says that the region is of no more use.
  void retire() noexcept { store(control_[kRetired], 1, std::memory_order_release); }

  /// The word that waiting readers watch.
  [[nodiscard]] const Word& revision_word() const noexcept { return control_[kRevision]; }

 private:
  /// Largest sum of magnitudes of what one revision writes. Values within ±kLargestValue at
  /// the shortest intervals make none so large, and within it every segment stays within what
  /// readers accept, whatever the interval.
  static constexpr double kLargestSum = 1e150;

  /// What this writer knows of a slot without looking: the node and the row that the newest
  /// committed cell names, as in its tag; which cell that is; and whether the slot has been written
  /// for the next revision.
  using SlotState = std::uint32_t;
  static constexpr SlotState kCellBit = 1U << 16;
  static constexpr SlotState kWrittenBit = 1U << 17;

  /// A slot that has been written for the next revision, and its state when that is committed.
  struct WrittenSlot {
    std::uint32_t index;
    SlotState next;
  };

  /// Where the slots lie, and what is known of them.
  struct Slots {
    Word* words;
    std::size_t mask;
    std::size_t slot_words;
    std::size_t cell_words;
    SlotState* states;
    WrittenSlot* written;           ///< each once
    std::size_t written_count = 0;  ///< at most as many as there are slots

    [[nodiscard]] Word* slot(std::size_t index) const noexcept {
      return words + index * slot_words;
    }
  };

  /// A slot whose spare cell has been claimed for the next revision.
  struct Claimed {
    Word* slot;
    Word* cell;
    SlotState next;

    /// Which one of the two parts of each kind is written.
    [[nodiscard]] std::size_t which_cell() const noexcept { return (next & kCellBit) != 0 ? 1 : 0; }
  };
  /// A packed time that has been stored to for the next revision, and what it was before.
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
  [[nodiscard]] SlotView<Word> head_cells() const noexcept {
    return {control_.data() + kHeadSlot, kHeadWords};
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
  std::span<Word> times_;
  Word revision_;
  Word settled_;
  Word late_;
  Word checked_;
  std::size_t head_cell_ = 0;                           ///< the newest committed one
  std::array<std::array<Word, kHeadWords>, 2> head_{};  ///< what both cells hold
  std::vector<SlotState> states_;
  std::vector<WrittenSlot> written_;
  Slots at_;  ///< in the region and in these
  std::vector<HeldTime> held_times_;
  double written_sum_ = 0;  ///< of the magnitudes of what readers see of the next revision
  double row_sum_ = 0;      ///< of those of its rows
};

}  // namespace splinecast::ipc
