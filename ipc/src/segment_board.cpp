#include "splinecast/ipc/segment_board.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::ipc {
namespace {

constexpr Word kFinishedFlag = 1;
constexpr Word kEnteredFlag = 2;
constexpr Word kStarvedFlag = 4;
constexpr std::size_t kBoundsWords = kHeadFlags;  // words 1 … 4
constexpr unsigned kShapeKindShift = 8;
constexpr unsigned kShapeSeenShift = 16;
constexpr Word kShapeWaypoint = Word{1} << 48U;
constexpr Word kByteMask = 0xff;
constexpr Word kSeenMask = 0xffffffff;
constexpr unsigned kRefusalItemShift = 8;

// Vectors of a cell behind the coefficients, in units of D words.
constexpr std::size_t kStepVector = core::kMaxOrder;
constexpr std::size_t kWaypointVector = kStepVector + 1;
constexpr std::size_t kGVector = kWaypointVector + 1;
constexpr std::size_t kResidualVector = kGVector + 1;
constexpr std::size_t kPrefixAfter = kResidualVector + 1;

std::size_t control_words() noexcept { return kControlLines * kSeparation / sizeof(Word); }

/// Largest sum of magnitudes of a segment's coefficients. Values within ±core::kLargestValue at the
/// shortest intervals make none so large, and within it no polynomial of ours leaves the range of a
/// double.
constexpr double kLargestSum = 1e200;

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

/// Whether a solver could have made a segment: evaluating it gives numbers.
bool is_sound(const SegmentCopy& segment, std::size_t values) noexcept {
  const Word length = to_word(segment.right) - to_word(segment.left);
  return magnitude(std::span(segment.coefficients).first(values)) <= kLargestSum &&
         segment.left <= segment.right && length <= to_word(core::Time::max()) &&
         segment.kind <= core::SegmentKind::hold;
}

/// Whether readers accept a segment, and a solver can continue from its left knot.
bool is_sound(std::span<const double> coefficients, const core::Segment& segment,
              const core::Knot& knot) noexcept {
  const core::SmoothingRow& row = knot.prefix.smoothing;
  const std::array prefix{knot.prefix.gamma, row.pivot, row.lower1, row.lower2};
  return magnitude(coefficients) <= kLargestSum &&
         std::isfinite(magnitude(segment.acceleration_step) + magnitude(knot.waypoint) +
                       magnitude(knot.g) + magnitude(knot.residual) + magnitude(prefix));
}

/// The members of a head that lookups need, out of its words 1 … kBoundsWords.
void take_bounds(std::span<const Word> words, Word r, Head& out) noexcept {
  out.revision = r;
  out.first = words[kHeadFirst - 1];
  out.newest = words[kHeadNewest - 1];
  out.settled_until = to_time(words[kHeadSettledUntil - 1]);
  out.finished = (words[kHeadFlags - 1] & kFinishedFlag) != 0;
}

}  // namespace

SegmentBoardWriter::SegmentBoardWriter(std::span<std::byte> region,
                                       const BoardLayout& layout) noexcept
    : layout_(layout),
      control_(words_at(region, layout.control, control_words())),
      head_(words_at(region, layout.head, 2 * kHeadWords)),
      refusals_(words_at(region, layout.refusals, kRefusalsKept)),
      times_(words_at(region, layout.times, layout.capacity)),
      slots_(words_at(region, layout.slots, layout.capacity * layout.stride / sizeof(Word))),
      revision_(load(control_[kRevision], std::memory_order_relaxed)) {
  retire_uncommitted(head_slot(), revision_);
  for (Word number = 0; number < layout_.capacity; ++number) {
    retire_uncommitted(slot(number), revision_);
  }
  const auto head = head_slot();
  const Word* const newest = head.cell(head.tags(std::memory_order_relaxed).newest(revision_));
  for (std::size_t i = 0; i < kHeadChangesKept; ++i) {
    changes_[i] = load(newest[kHeadChanges + i], std::memory_order_relaxed);
  }
}

SlotView<Word> SegmentBoardWriter::slot(Word number) const noexcept {
  const std::size_t index = number & (layout_.capacity - 1);
  return {slots_.subspan(index * (layout_.stride / sizeof(Word))).data(),
          layout_.cell / sizeof(Word)};
}

SlotView<Word> SegmentBoardWriter::head_slot() const noexcept { return {head_.data(), kHeadWords}; }

/// Asks for the lines of a slot that will soon be written: they were last touched when the board
/// came round the time before, and would else be waited for one after the other.
void SegmentBoardWriter::prefetch(Word number) const noexcept {
  const SlotView<Word> at = slot(number);
  prefetch_lines(at.words, 2 * at.cell_words * sizeof(Word));
}

void SegmentBoardWriter::prefetch_tags(Word number) const noexcept {
  const SlotView<Word> at = slot(number);
  for (std::size_t c = 0; c < 2; ++c) prefetch_lines(at.cell(c), sizeof(Word));
}

void SegmentBoardWriter::prefetch_head() const noexcept {
  prefetch_lines(&control_[kRevision], sizeof(Word));
  prefetch_lines(&control_[kTail], sizeof(Word));
  const SlotView<Word> head = head_slot();
  for (std::size_t c = 0; c < 2; ++c) {
    prefetch_lines(head.cell(c), (kHeadReasons + kRefusalReasons) * sizeof(Word));
    prefetch_lines(head.cell(c) + kHeadChanges + (revision_ + 1) % kHeadChangesKept, sizeof(Word));
  }
}

Word* SegmentBoardWriter::claim(Word number) noexcept {
  if (number > newest_claimed_) {
    newest_claimed_ = number;
    prefetch(number + 1);
  }
  lowest_written_ = std::min(lowest_written_, number);
  highest_written_ = std::max(highest_written_, number);
  return claim_spare(slot(number), revision_ + 1);
}

void SegmentBoardWriter::write(Word number, const core::Segment& segment, const core::Knot& knot,
                               const SegmentOrigin& origin) noexcept {
  const std::size_t dimensions = layout_.dimensions;
  const auto coefficients =
      std::span(segment.coefficients).first(static_cast<std::size_t>(segment.order) * dimensions);
  is_sound_ = is_sound_ && ipc::is_sound(coefficients, segment, knot);
  Word* const cell = claim(number);
  put(cell[kCellNumber], number);
  put(cell[kCellLeft], to_word(segment.left));
  put(cell[kCellRight], to_word(segment.right));
  put(cell[kCellShape], static_cast<Word>(segment.order) |
                            static_cast<Word>(segment.kind) << kShapeKindShift |
                            static_cast<Word>(knot.newer_knots) << kShapeSeenShift |
                            (knot.waypoint.empty() ? 0 : kShapeWaypoint));
  put(cell[kCellRightSeen], origin.right_newer_knots);
  put(cell[kCellItem], origin.item ? *origin.item + 1 : 0);
  Word* const vectors = cell + kCellCoefficients;
  store_values(vectors, coefficients);
  store_values(vectors + kStepVector * dimensions, segment.acceleration_step);
  store_values(vectors + kWaypointVector * dimensions, knot.waypoint);
  store_values(vectors + kGVector * dimensions, knot.g);
  Word* const prefix = vectors + kPrefixAfter * dimensions;
  put(prefix[0], to_word(knot.prefix.gamma));
  // A hint only: readers confirm it in the cell, so no ordering is needed.
  store(times_[number & (layout_.capacity - 1)], to_word(segment.left), std::memory_order_relaxed);
  if (knot.residual.empty()) return;  // what follows only smoothing has
  store_values(vectors + kResidualVector * dimensions, knot.residual);
  put(prefix[1], to_word(knot.prefix.smoothing.pivot));
  put(prefix[2], to_word(knot.prefix.smoothing.lower1));
  put(prefix[3], to_word(knot.prefix.smoothing.lower2));
}

void SegmentBoardWriter::write_cut(Word number, core::Time right) noexcept {
  const SlotView<Word> at = slot(number);
  const Word* const committed =
      at.cell(at.tags(std::memory_order_relaxed).newest(revision_));  // W0
  Word* const cell = claim(number);
  for (std::size_t i = kCellNumber; i < at.cell_words; ++i) {
    put(cell[i], load(committed[i], std::memory_order_relaxed));
  }
  put(cell[kCellRight], to_word(right));
}

void SegmentBoardWriter::discard() noexcept {
  retire_uncommitted(head_slot(), revision_);
  for (Word number = lowest_written_; number <= highest_written_; ++number) {
    const SlotView<Word> at = slot(number);
    retire_uncommitted(at, revision_);
    const Tags tags = at.tags(std::memory_order_relaxed);
    if (!tags.holds_any(revision_)) continue;
    const Word* const cell = at.cell(tags.newest(revision_));
    store(times_[number & (layout_.capacity - 1)], load(cell[kCellLeft], std::memory_order_relaxed),
          std::memory_order_relaxed);
  }
  forget_written();
}

void SegmentBoardWriter::forget_written() noexcept {
  lowest_written_ = std::numeric_limits<Word>::max();
  highest_written_ = 0;
  is_sound_ = true;
}

void SegmentBoardWriter::write_refusal(Word index, const RefusedItem& refusal) noexcept {
  // One word, so that it is never torn; published by the commit of the head that counts it.
  put(refusals_[index % kRefusalsKept],
      refusal.item << kRefusalItemShift | static_cast<Word>(refusal.reason));
}

void SegmentBoardWriter::commit(Head& head) noexcept {
  const Word r = revision_ + 1;
  head.revision = r;
  changes_[r % kHeadChangesKept] = to_word(head.changed_from);
  // The spare cell is mostly that of two revisions ago, and then holds all that had changed until
  // then. Those words stand as they are: stored before this revision's tag is (W1, release), by
  // this writer or by one whose lock it has taken over, they are seen by whoever acquires that tag.
  const SlotView<Word> slot = head_slot();
  const std::size_t spare = 1 - slot.tags(std::memory_order_relaxed).newest(revision_);
  const Word spare_tag = load(slot.cell(spare)[kCellTag], std::memory_order_relaxed);
  const Word changes_known =
      r > 2 && spare_tag == r - 2 ? r - 2 : r - std::min<Word>(r, kHeadChangesKept);
  Word* const cell = claim_spare(slot, r);
  put(cell[kHeadFirst], head.first);
  put(cell[kHeadNewest], head.newest);
  put(cell[kHeadSettledUntil], to_word(head.settled_until));
  put(cell[kHeadFlags], (head.finished ? kFinishedFlag : 0) | (head.is_entered ? kEnteredFlag : 0) |
                            (head.starved ? kStarvedFlag : 0));
  put(cell[kHeadChangedFrom], to_word(head.changed_from));
  put(cell[kHeadConsumed], head.consumed);
  put(cell[kHeadKnots], head.knots);
  put(cell[kHeadNewestKnot], to_word(head.newest_knot));
  put(cell[kHeadCommitted], to_word(head.committed));
  put(cell[kHeadRefused], head.refused);
  put(cell[kHeadRun], head.run);
  put(cell[kHeadRunKnots], head.run_knots);
  put(cell[kHeadRunFrozen], head.run_frozen);
  put(cell[kHeadLowWater], to_word(head.low_water));
  put(cell[kHeadUnderruns], head.underruns);
  put(cell[kHeadMisses], head.misses);
  put(cell[kHeadRevisions], head.revisions);
  put(cell[kHeadWithdrawn], head.withdrawn);
  put(cell[kHeadControls], head.controls);
  for (std::size_t i = 0; i < kRefusalReasons; ++i) put(cell[kHeadReasons + i], head.reasons[i]);
  for (Word k = changes_known + 1; k <= r; ++k) {
    put(cell[kHeadChanges + k % kHeadChangesKept], changes_[k % kHeadChangesKept]);
  }
  store(control_[kRevision], r, std::memory_order_release);  // W3
  revision_ = r;
  forget_written();
}

void SegmentBoardWriter::store_checked(bool is_late) noexcept {
  if (is_late) store(control_[kLate], revision_, std::memory_order_relaxed);
  store(control_[kChecked], revision_, std::memory_order_release);
}

bool SegmentBoardWriter::is_checked() const noexcept {
  return load(control_[kChecked], std::memory_order_relaxed) == revision_;
}

bool SegmentBoardWriter::is_late() const noexcept {
  return revision_ > 0 && load(control_[kLate], std::memory_order_relaxed) == revision_;
}

SegmentBoardReader::SegmentBoardReader(std::span<const std::byte> region,
                                       const BoardLayout& layout) noexcept
    : layout_(layout),
      control_(words_at(region, layout.control, control_words())),
      head_(words_at(region, layout.head, 2 * kHeadWords)),
      refusals_(words_at(region, layout.refusals, kRefusalsKept)),
      times_(words_at(region, layout.times, layout.capacity)),
      slots_(words_at(region, layout.slots, layout.capacity * layout.stride / sizeof(Word))) {}

SlotView<const Word> SegmentBoardReader::slot(Word number) const noexcept {
  const std::size_t index = number & (layout_.capacity - 1);
  return {slots_.subspan(index * (layout_.stride / sizeof(Word))).data(),
          layout_.cell / sizeof(Word)};
}

SlotView<const Word> SegmentBoardReader::head_slot() const noexcept {
  return {head_.data(), kHeadWords};
}

/// Whether the segments of a head, words 1 … kBoundsWords, can all lie on this board, and its time
/// is one; no writer of ours says otherwise.
bool SegmentBoardReader::has_sane_bounds(std::span<const Word> words) const noexcept {
  const Word first = words[kHeadFirst - 1];
  const Word newest = words[kHeadNewest - 1];
  if (!is_time_in_range(to_time(words[kHeadSettledUntil - 1]))) return false;
  if (newest == 0) return true;
  return first >= 1 && first <= newest && newest - first < layout_.capacity &&
         newest != kRetiredTag;
}

void SegmentBoardReader::prefetch(Word r, Word number) const noexcept {
  const auto head = head_slot();
  const auto own = slot(number);
  const auto next = slot(number + 1);
  for (std::size_t c = 0; c < 2; ++c) {
    __builtin_prefetch(head.cell(c));
    __builtin_prefetch(head.cell(c) + kHeadChanges + r % kHeadChangesKept);
    __builtin_prefetch(own.cell(c));
    __builtin_prefetch(next.cell(c));
  }
}

void SegmentBoardReader::prefetch_segment(Word number) const noexcept {
  const auto at = slot(number);
  const std::size_t words = kCellCoefficients + core::kCubicOrder * layout_.dimensions;
  for (std::size_t c = 0; c < 2; ++c) prefetch_lines(at.cell(c), words * sizeof(Word));
}

bool SegmentBoardReader::copy_bounds(Word r, Word seen, Head& out) const noexcept {
  const auto view = head_slot();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  const Word* const cell = view.cell(c);
  std::array<Word, kBoundsWords> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = load(cell[1 + i], std::memory_order_acquire);
  }
  core::Time earliest = core::Time::max();
  const Word missed = r - seen;  // very many if the commit word went back: no writer of ours does
  if (missed > kHeadChangesKept) earliest = core::Time::min();
  for (Word back = 0; back < missed && missed <= kHeadChangesKept; ++back) {
    const Word at = kHeadChanges + (r - back) % kHeadChangesKept;
    earliest = std::min(earliest, to_time(load(cell[at], std::memory_order_acquire)));
  }
  if (load(cell[0], std::memory_order_relaxed) != tags.of[c]) return false;
  if (!has_sane_bounds(words)) return false;
  take_bounds(words, r, out);
  out.changed_from = earliest;
  return true;
}

bool SegmentBoardReader::copy_head(Word r, Head& out) const noexcept {
  std::array<Word, kHeadReasons + kRefusalReasons - 1> words{};
  if (copy_newest(head_slot(), r, words.size(), words.data()) == 0) return false;
  const auto word = [&](std::size_t at) { return words[at - 1]; };
  if (!has_sane_bounds(words) || !is_time_in_range(to_time(word(kHeadNewestKnot))) ||
      !is_time_in_range(to_time(word(kHeadCommitted)))) {
    return false;
  }
  take_bounds(words, r, out);
  out.changed_from = to_time(word(kHeadChangedFrom));
  out.consumed = word(kHeadConsumed);
  out.knots = word(kHeadKnots);
  out.newest_knot = to_time(word(kHeadNewestKnot));
  out.committed = to_time(word(kHeadCommitted));
  out.refused = word(kHeadRefused);
  out.run = word(kHeadRun);
  out.run_knots = word(kHeadRunKnots);
  out.run_frozen = word(kHeadRunFrozen);
  out.is_entered = (word(kHeadFlags) & kEnteredFlag) != 0;
  out.starved = (word(kHeadFlags) & kStarvedFlag) != 0;
  out.low_water = to_time(word(kHeadLowWater));
  out.underruns = word(kHeadUnderruns);
  out.misses = word(kHeadMisses);
  const bool is_late = r > 0 && load(control_[kLate], std::memory_order_relaxed) == r;
  out.revisions = word(kHeadRevisions) + (is_late ? 1 : 0);
  out.withdrawn = word(kHeadWithdrawn);
  out.controls = word(kHeadControls);
  for (std::size_t i = 0; i < kRefusalReasons; ++i) out.reasons[i] = word(kHeadReasons + i);
  return true;
}

bool SegmentBoardReader::copy_segment(Word number, Word r, SegmentCopy& out) const noexcept {
  out.tag = 0;
  const auto view = slot(number);
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  const Word* const cell = view.cell(c);
  const auto word = [cell](std::size_t i) { return load(cell[i], std::memory_order_acquire); };
  out.number = word(kCellNumber);
  out.left = to_time(word(kCellLeft));
  out.right = to_time(word(kCellRight));
  const Word shape = word(kCellShape);
  out.order = (shape & kByteMask) == core::kCubicOrder ? core::kCubicOrder : core::kMaxOrder;
  out.kind = static_cast<core::SegmentKind>((shape >> kShapeKindShift) & kByteMask);
  out.newer_knots = static_cast<std::uint32_t>((shape >> kShapeSeenShift) & kSeenMask);
  out.has_waypoint = (shape & kShapeWaypoint) != 0;
  out.origin = {.right_newer_knots = static_cast<std::uint32_t>(word(kCellRightSeen)), .item = {}};
  if (const Word item = word(kCellItem); item > 0) out.origin.item = item - 1;
  const std::size_t values = static_cast<std::size_t>(out.order) * layout_.dimensions;
  load_values(std::span(out.coefficients).first(values), cell + kCellCoefficients);
  if (load(cell[kCellTag], std::memory_order_relaxed) != tags.of[c] || out.number != number ||
      !is_sound(out, values)) {
    return false;
  }
  out.tag = tags.of[c];
  out.cell = c;
  return true;
}

bool SegmentBoardReader::is_current(const SegmentCopy& copy, Word r) const noexcept {
  return copy.tag != 0 && is_newest(slot(copy.number), copy.cell, copy.tag, r);
}

bool SegmentBoardReader::copy_left(Word number, Word r, core::Time& left) const noexcept {
  std::array<Word, kCellLeft> words{};
  if (copy_newest(slot(number), r, words.size(), words.data()) == 0) return false;
  left = to_time(words[kCellLeft - 1]);
  return words[kCellNumber - 1] == number;
}

bool SegmentBoardReader::copy_ends(Word number, Word r, core::Time& left,
                                   core::Time& right) const noexcept {
  std::array<Word, kCellRight> words{};
  if (copy_newest(slot(number), r, words.size(), words.data()) == 0) return false;
  left = to_time(words[kCellLeft - 1]);
  right = to_time(words[kCellRight - 1]);
  return words[kCellNumber - 1] == number;
}

void SegmentBoardReader::copy_step(const SegmentCopy& copy, std::span<double> step) const noexcept {
  copy_vector(copy, kStepVector, step);
}

void SegmentBoardReader::copy_waypoint(const SegmentCopy& copy,
                                       std::span<double> position) const noexcept {
  copy_vector(copy, kWaypointVector, position);
}

void SegmentBoardReader::copy_vector(const SegmentCopy& copy, std::size_t vector,
                                     std::span<double> out) const noexcept {
  const Word* const cell = slot(copy.number).cell(copy.cell);
  const Word* const words = cell + kCellCoefficients + vector * layout_.dimensions;
  for (std::size_t d = 0; d < out.size(); ++d) {
    out[d] = to_double(load(words[d], std::memory_order_acquire));
  }
}

RefusedItem SegmentBoardReader::refusal(Word index) const noexcept {
  const Word word = load(refusals_[index % kRefusalsKept], std::memory_order_acquire);
  return {.item = word >> kRefusalItemShift, .reason = static_cast<Refusal>(word & kByteMask)};
}

std::size_t SegmentBoardReader::copy_refusals(const Head& head, Word from,
                                              std::span<RefusedItem> out) const noexcept {
  const Word wanted = head.refused - std::min(from, head.refused);
  const std::size_t most = std::min<Word>({wanted, kRefusalsKept, out.size()});
  Word next = head.consumed;  // the item before which this one must come
  std::size_t count = 0;
  for (; count < most; ++count) {
    const RefusedItem item = refusal(head.refused - 1 - count);
    if (item.item >= next) break;  // overwritten, and so are all before it
    next = item.item;
    out[count] = item;
  }
  std::ranges::reverse(out.first(count));
  return count;
}

core::Knot SegmentBoardReader::knot(Word number, Word r, std::span<double> values) const noexcept {
  const std::size_t dimensions = layout_.dimensions;
  const auto view = slot(number);
  const Word* const cell = view.cell(view.tags(std::memory_order_relaxed).newest(r));
  const Word* const vectors = cell + kCellCoefficients;
  const auto take = [&](std::size_t part, std::size_t vector) {
    const auto out = values.subspan(part * dimensions, dimensions);
    for (std::size_t d = 0; d < dimensions; ++d) {
      out[d] = to_double(load(vectors[vector * dimensions + d], std::memory_order_relaxed));
    }
    return out;
  };
  const auto prefix = [&](std::size_t i) {
    const Word word = load(vectors[kPrefixAfter * dimensions + i], std::memory_order_relaxed);
    return to_double(word);
  };
  const auto acceleration = take(4, 2);
  for (double& a : acceleration) a *= 2;
  const Word shape = load(cell[kCellShape], std::memory_order_relaxed);
  const auto waypoint = take(0, kWaypointVector);
  return {.time = to_time(load(cell[kCellLeft], std::memory_order_relaxed)),
          .prefix = {.gamma = prefix(0),
                     .smoothing = {.pivot = prefix(1), .lower1 = prefix(2), .lower2 = prefix(3)}},
          .newer_knots = static_cast<std::uint32_t>((shape >> kShapeSeenShift) & kSeenMask),
          .waypoint = (shape & kShapeWaypoint) != 0 ? waypoint : waypoint.first(0),
          .g = take(1, kGVector),
          .position = take(2, 0),
          .velocity = take(3, 1),
          .acceleration = acceleration,
          .residual = take(5, kResidualVector)};
}

}  // namespace splinecast::ipc
