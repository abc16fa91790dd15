#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/segment.hpp"
#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/publication.hpp"
#include "splinecast/ipc/status.hpp"

/// The segment board: the segments of a stream and the head that goes with each revision, over a
/// span of bytes. One solver writes it, by publication.hpp; anybody reads. Segments are numbered
/// from 1; segment n lies in slot n modulo the capacity.
///
/// Orderings of the words outside the slots; those of the cells are publication.hpp's:
///
/// - `tail` and `sleeping`: S3, P3 and the sleep of waypoint_ring.hpp. `tail` follows the commit,
/// so
///   that a solver that dies between the two has its items consumed: the next one stores it again.
/// - `late` and `checked`, which are stored after the commit, when it is known whether it came too
///   late: first `late`, if it did, then `checked`. If a writer dies before `checked`, its
///   successor decides about that revision. Others load them relaxed: each is a number of its own.
/// - Packed knot times: relaxed. They are a hint; the cell that they lead to decides.
/// - Refusals: one word each, which is never torn, stored before W3 of the head that counts it and
///   loaded after R1. A later refusal, committed or not, overwrites the oldest one first; it is of
///   a later item. So a word is the refusal of its index iff its item comes before that of the next
///   index; the last one's item must come before the first item not consumed under that head.
/// - `retired`: stored with release and loaded with acquire; nothing depends on more than the word.
/// - What the writer loads of its own board is relaxed: it made these stores itself, or its
///   predecessor did, whose death the kernel told by giving the owner's lock away.
namespace splinecast::ipc {

/// What holds for a whole revision.
struct Head {
  Word revision = 0;           ///< the revision that this head is of; 0: none yet
  Word first = 0;              ///< oldest segment on the board
  Word newest = 0;             ///< newest segment, the stop tail of a stream that goes on; 0: none
  core::Time settled_until{};  ///< no time before it ever changes
  bool finished = false;
  core::Time changed_from{};  ///< earliest time whose curve this revision changed
  Word consumed = 0;          ///< ring items taken
  Word knots = 0;             ///< waypoints interpolated, replaced ones too
  core::Time newest_knot{};   ///< time of the newest knot
  core::Time committed{};     ///< the solver's clock at the commit
  Word run = 1;               ///< number of the first segment of the run
  Word run_knots = 0;         ///< knots of the run
  Word run_frozen = 0;        ///< of these, frozen when this revision was made
  bool is_entered = false;    ///< the run begins with a splice
  bool starved = false;       ///< a live stream's settled time has passed its newest knot
  core::Time low_water = core::Time::max();  ///< least depth so far; max() before there was any
  Word underruns = 0;                        ///< times that a live stream has starved
  Word misses = 0;                           ///< revisions discarded because they came too late
  Word revisions = 0;  ///< revisions committed too late, this one too: readers are told
  Word withdrawn = 0;  ///< items that a replacement withdrew unread
  Word controls = 0;   ///< replacements, start states and finishes carried out
  Word refused = 0;    ///< items refused
  std::array<Word, kRefusalReasons> reasons{};  ///< of these, by Refusal
};

/// An item that the solver refused.
struct RefusedItem {
  Word item = 0;
  Refusal reason{};
};

/// What else a segment came from, for whoever solves it again.
struct SegmentOrigin {
  std::uint32_t right_newer_knots = 0;  ///< that its right knot had seen when it was last solved
  std::optional<Word> item{};           ///< of the splice into a run: the run's first waypoint
};

/// The solver's side. One thread of one process uses it; no function blocks or allocates.
class SegmentBoardWriter {
 public:
  /// `region` holds a board of this layout and outlives the writer. Retires whatever a writer
  /// before this one had not committed (T1).
  SegmentBoardWriter(std::span<std::byte> region, const BoardLayout& layout) noexcept;

  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }

  /// The last revision that was committed.
  [[nodiscard]] Word revision() const noexcept { return revision_; }

  /// Writes a segment, and what a solver needs of its left knot in order to go on, for the next
  /// revision. Of a segment that begins at no knot `knot.waypoint` is empty; of a splice `knot.g`
  /// is the acceleration that it ends with, and `knot.newer_knots` how many knots stood behind its
  /// right one when it was last shaped. At most `capacity` different numbers in one revision.
  void write(Word number, const core::Segment& segment, const core::Knot& knot,
             const SegmentOrigin& origin = {}) noexcept;

  /// Whether all that was written for the next revision is what readers, and a solver that takes
  /// over, accept: finite values, and coefficients within their bound. Else it must be discarded.
  [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }

  /// Writes committed segment `number` again with another right end, for the next revision.
  void write_cut(Word number, core::Time right) noexcept;

  /// Asks for the lines of the head that the next revision will store to.
  void prefetch_head() const noexcept;
  /// Likewise for the tags of a segment, on which it depends which cell that is.
  void prefetch_tags(Word number) const noexcept;

  /// Takes back what has been written for the next revision, as a takeover does (T1).
  void discard() noexcept;

  /// Notes a refusal beside the head.
  void write_refusal(Word index, const RefusedItem& refusal) noexcept;

  /// Writes the head of the next revision and commits it: all of it becomes visible at once.
  /// `head.revision` is set.
  void commit(Head& head) noexcept;

  /// Tells the producer what has been consumed, after the commit: S3.
  void store_tail(Word consumed) noexcept {
    store(control_[kTail], consumed, std::memory_order_release);
  }

  /// Notes, behind the commit, that the newest revision was compared with the clock, and whether it
  /// came too late.
  void store_checked(bool is_late) noexcept;

  /// Whether the newest revision has been compared so, and whether it was found to be too late.
  [[nodiscard]] bool is_checked() const noexcept;
  [[nodiscard]] bool is_late() const noexcept;

  /// For a solver about to sleep, or awake again: seq_cst, see waypoint_ring.hpp.
  void store_sleeping(bool sleeping) noexcept {
    store(control_[kSleeping], sleeping ? 1 : 0, std::memory_order_seq_cst);
  }

  /// Says that the region is of no more use.
  void retire() noexcept { store(control_[kRetired], 1, std::memory_order_release); }

  /// The word that waiting readers watch.
  [[nodiscard]] const Word& revision_word() const noexcept { return control_[kRevision]; }

 private:
  [[nodiscard]] SlotView<Word> slot(Word number) const noexcept;
  [[nodiscard]] SlotView<Word> head_slot() const noexcept;
  [[nodiscard]] Word* claim(Word number) noexcept;
  void prefetch(Word number) const noexcept;
  void forget_written() noexcept;

  BoardLayout layout_;
  std::span<Word> control_;
  std::span<Word> head_;
  std::span<Word> refusals_;
  std::span<Word> times_;
  std::span<Word> slots_;
  Word revision_;
  std::array<Word, kHeadChangesKept> changes_{};
  Word lowest_written_ = std::numeric_limits<Word>::max();  ///< for the next revision
  Word highest_written_ = 0;
  bool is_sound_ = true;     ///< what has been written for the next revision
  Word newest_claimed_ = 0;  ///< the segments behind it are in no cache
};

/// A reader's own copy of a segment. Allocates when made only.
struct SegmentCopy {
  explicit SegmentCopy(std::size_t dimensions)
      : coefficients(static_cast<std::size_t>(core::kMaxOrder) * dimensions) {}

  Word tag = 0;          ///< revision that wrote it; 0: nothing copied
  std::size_t cell = 0;  ///< of its slot, 0 or 1: where it was copied from
  Word number = 0;
  core::Time left{};
  core::Time right{};
  int order = core::kCubicOrder;
  core::SegmentKind kind{};
  std::uint32_t newer_knots = 0;  ///< that its left knot had seen when it was last solved
  SegmentOrigin origin{};
  bool has_waypoint = false;         ///< whether its left end is a waypoint
  std::vector<double> coefficients;  ///< [power][dimension]; of these the first `order` powers
  std::vector<double> acceleration_step{};  ///< a⁺ − a⁻ at the left end: in a snapshot as readers
                                            ///< see it, of a SettledSegments as solved
  std::vector<double>
      waypoint{};  ///< position of the waypoint at the left end; of a SettledSegments
};

/// A reader's side; no function blocks, allocates or stores. Every copy is taken under a revision
/// `r` that the caller has loaded, and fails if the writer has gone on too far meanwhile, or if
/// what lies there is nothing that a solver writes: whatever the bytes are, each call takes a
/// bounded number of steps within the region, and a copied segment evaluates to numbers anywhere
/// between its ends.
class SegmentBoardReader {
 public:
  /// `region` holds a board of this layout and outlives the reader.
  SegmentBoardReader(std::span<const std::byte> region, const BoardLayout& layout) noexcept;

  [[nodiscard]] std::size_t dimensions() const noexcept { return layout_.dimensions; }
  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }

  /// R1: the newest revision; 0: none yet.
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
  /// Whether the solver sleeps; seq_cst, see waypoint_ring.hpp.
  [[nodiscard]] bool sleeping() const noexcept {
    return load(control_[kSleeping], std::memory_order_seq_cst) != 0;
  }

  /// Asks for the lines that a reader with a copy of segment `number` will load of a revision it
  /// has not seen, all at once: each has to come from the writer's core, and would else be waited
  /// for one after the other. Loads nothing.
  void prefetch(Word r, Word number) const noexcept;

  /// Likewise for a segment anywhere: the lines of both cells, because the tags, which say which
  /// one counts, would else be waited for first.
  void prefetch_segment(Word number) const noexcept;

  /// Copies what lookups need of the head under r: revision, first, newest, settled_until,
  /// finished; and the earliest changed_from of the revisions after `seen` up to r, min() if there
  /// are more than are kept. The other members stay, and upon failure all of them.
  [[nodiscard]] bool copy_bounds(Word r, Word seen, Head& out) const noexcept;

  /// Copies the whole head under r. Upon failure `out` stays as it is.
  [[nodiscard]] bool copy_head(Word r, Head& out) const noexcept;

  /// Copies segment `number` under r. Upon failure `out.tag` is 0 and the rest of no use.
  [[nodiscard]] bool copy_segment(Word number, Word r, SegmentCopy& out) const noexcept;

  /// Whether a copy is what the board holds under r too: no words are copied again. K1 and K2; r is
  /// no older than the revision that the copy was made under.
  [[nodiscard]] bool is_current(const SegmentCopy& copy, Word r) const noexcept;

  /// Copies the left end, or both ends, of segment `number` under r.
  [[nodiscard]] bool copy_left(Word number, Word r, core::Time& left) const noexcept;
  [[nodiscard]] bool copy_ends(Word number, Word r, core::Time& left,
                               core::Time& right) const noexcept;

  /// Copies the acceleration step at the left end of a segment that has been copied: D values. What
  /// it gives is of use iff the copy is current afterwards, which is R4 for these words (R3).
  void copy_step(const SegmentCopy& copy, std::span<double> step) const noexcept;

  /// Likewise the position of the waypoint at its left end, if it has one.
  void copy_waypoint(const SegmentCopy& copy, std::span<double> position) const noexcept;

  /// The left end of segment `number` from the packed array: a hint, to be confirmed in the cell.
  [[nodiscard]] core::Time left_hint(Word number) const noexcept {
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

  /// What a new solver needs of a knot: copied into `values` (kKnotValues·D), which the returned
  /// spans view. Position, velocity and acceleration are those that its segment begins with; the
  /// waypoint is empty where none stands. For the one writer only, who races with nobody.
  static constexpr std::size_t kKnotValues = 6;
  [[nodiscard]] core::Knot knot(Word number, Word r, std::span<double> values) const noexcept;

 private:
  [[nodiscard]] SlotView<const Word> slot(Word number) const noexcept;
  [[nodiscard]] SlotView<const Word> head_slot() const noexcept;
  void copy_vector(const SegmentCopy& copy, std::size_t vector,
                   std::span<double> out) const noexcept;
  [[nodiscard]] bool has_sane_bounds(std::span<const Word> words) const noexcept;

  BoardLayout layout_;
  std::span<const Word> control_;
  std::span<const Word> head_;
  std::span<const Word> refusals_;
  std::span<const Word> times_;
  std::span<const Word> slots_;
};

}  // namespace splinecast::ipc
