#include <algorithm>
#include <utility>

#include "ipc/board/knot_board.hpp"
#include "ipc/board/tag.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

constexpr unsigned kRefusalItemShift = 8;
constexpr Word kByteMask = 0xff;

/// Words of a head's cell that lookups need, behind its tag.
constexpr std::size_t kBoundsWords = word_of(kHeadFields, "finished");

/// Whether a knot of ours can stand at a time: a waypoint, or, behind the last one, the end of a
/// stop or of the way back from there.
bool is_knot_time(Time time) noexcept {
  return time >= -kLatestTime && time <= kLatestTime + 2 * kLongestStop;
}

/// Whether the knots of a head can all lie on a board, and its times are some; no writer of ours
/// says otherwise.
bool has_sane_bounds(const Head& head, std::size_t capacity) noexcept {
  if (!is_time_in_range(head.settled_until)) return false;
  if (head.newest == 0) return true;
  return head.first >= 1 && head.first <= head.newest && head.newest - head.first < capacity &&
         head.newest <= std::numeric_limits<Word>::max() / 2 && head.stop >= Time::zero() &&
         head.stop <= kLongestStop;
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
      times_(words_at(region, layout.times, layout.capacity)),
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
  const auto head = head_cells();
  for (std::size_t c = 0; c < 2; ++c) __builtin_prefetch(head.cell(c));
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

/// C2: the earliest of the times that the revisions after `seen` up to r changed the curve from;
/// min() where not all of these are there any more.
Time KnotBoardReader::earliest_change(Word seen, Word r) const noexcept {
  const Word missed = r - seen;  // very many if the commit word went back: no writer of ours does
  if (missed >= kChangesKept) return Time::min();
  Time earliest = Time::max();
  for (Word back = 0; back < missed; ++back) {
    const Word& word = control_[kChanges + (r - back) % kChangesKept];
    earliest = std::min(earliest, to_time(load(word, std::memory_order_acquire)));
  }
  // C3. One word fewer than there are counts: a writer that died may have stored the next one. And
  // where both tags have been retired since, nothing says how far writers have come.
  const Tags tags = head_cells().tags(std::memory_order_acquire);
  bool stands = false;
  for (const Word tag : tags.of) {
    if (tag == kRetiredTag) continue;
    if (revision_of(tag) > seen + kChangesKept - 1) return Time::min();
    stands = true;
  }
  return stands ? earliest : Time::min();
}

bool KnotBoardReader::copy_bounds(const Look& look, Word seen, Head& out) const noexcept {
  const Word r = look.revision;
  const Time changed_from = earliest_change(seen, r);
  const auto view = head_cells();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  const Word* const cell = view.cell(c);
  std::array<Word, kBoundsWords + 1> words{};
  for (std::size_t i = 1; i < words.size(); ++i)
    words[i] = load(cell[i], std::memory_order_acquire);
  if (load(cell[0], std::memory_order_relaxed) != tags.of[c]) return false;
  Head bounds;
  bounds.first = words[word_of(kHeadFields, "first")];
  bounds.newest = words[word_of(kHeadFields, "newest")];
  bounds.stop = to_time(words[word_of(kHeadFields, "stop")]);
  bounds.settled_until = look.settled_until;
  if (!has_sane_bounds(bounds, layout_.capacity)) return false;
  out.revision = r;
  out.first = bounds.first;
  out.newest = bounds.newest;
  out.stop = bounds.stop;
  out.finished = words[word_of(kHeadFields, "finished")] != 0;
  out.settled_until = look.settled_until;
  out.changed_from = changed_from;
  return true;
}

bool KnotBoardReader::copy_head(const Look& look, Head& out) const noexcept {
  const Word r = look.revision;
  const Time changed_from = earliest_change(r - 1, r);
  const auto view = head_cells();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  std::array<Word, kHeadWords> words{};
  for (std::size_t i = 1; i < words.size(); ++i) {
    words[i] = load(view.cell(c)[i], std::memory_order_acquire);
  }
  if (load(view.cell(c)[0], std::memory_order_relaxed) != tags.of[c]) return false;
  Head head;
  decode(kHeadRows, words.data(), head);
  head.revision = r;
  head.settled_until = look.settled_until;
  head.changed_from = changed_from;
  if (!has_sane_bounds(head, layout_.capacity) || !is_time_in_range(head.newest_knot) ||
      !is_time_in_range(head.committed)) {
    return false;
  }
  const bool is_late = r > 0 && load(control_[kLate], std::memory_order_relaxed) == r;
  head.revisions += is_late ? 1 : 0;
  out = head;
  return true;
}

bool KnotBoardReader::copy_newest_head(Head& out) const noexcept {
  constexpr int kTries = 16;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Look seen = look();
    if (seen.revision == 0) return false;
    if (copy_head(seen, out)) return true;
  }
  return false;
}

bool KnotBoardReader::copy_knot(Word number, Word r, KnotCopy& out) const noexcept {
  out.number = number;
  return copy_slot(index_of(number), r, out);
}

bool KnotBoardReader::copy_passed(Word i, Word r, KnotCopy& out) const noexcept {
  out.number = 0;
  return copy_slot(layout_.capacity + i % kPassedSlots, r, out);
}

/// The knot in a slot: R2 to R4.
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
  const bool stands = load(cell[kCellTag], std::memory_order_relaxed) == tag;  // R4
  if (!stands || static_cast<int>(out.note.form) >= core::kSegmentForms ||
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

RefusedItem KnotBoardReader::refusal(Word index) const noexcept {
  const Word word = load(refusals_[index % kRefusalsKept], std::memory_order_acquire);
  return {.item = word >> kRefusalItemShift, .reason = static_cast<Refusal>(word & kByteMask)};
}

std::size_t KnotBoardReader::copy_refusals(const Head& head, Word from,
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

std::optional<LimitExcess> KnotBoardReader::excess(const Head& head, Word index) const noexcept {
  if (index >= head.exceeding || head.exceeding - index > kExcessesKept) return std::nullopt;
  const auto words = excesses_.subspan(index % kExcessesKept * kExcessWords, kExcessWords);
  const Word tag = load(words[0], std::memory_order_acquire);
  constexpr Word kKindMask = 7;
  constexpr Word kDimensionMask = kMaxDimensions - 1;
  const LimitExcess found{.item = tag >> kExcessItemShift,
                          .is_refused = (tag & 1U) != 0,
                          .kind = static_cast<LimitKind>((tag >> 1U & kKindMask) % kLimitKinds),
                          .dimension = tag >> kExcessDimensionShift & kDimensionMask,
                          .time = to_time(load(words[1], std::memory_order_acquire)),
                          .value = to_double(load(words[2], std::memory_order_acquire)),
                          .limit = to_double(load(words[3], std::memory_order_acquire))};
  const bool is_whole = tag != 0 && load(words[0], std::memory_order_relaxed) == tag;
  return is_whole && found.item < head.consumed ? std::optional(found) : std::nullopt;
}

std::optional<LimitExcess> KnotBoardReader::excess_of(const Head& head, Word item) const noexcept {
  const Word kept = std::min<Word>(head.exceeding, kExcessesKept);
  for (Word back = 1; back <= kept; ++back) {
    const auto found = excess(head, head.exceeding - back);
    if (found && found->item == item) return found;
  }
  return std::nullopt;
}

core::Prefix KnotBoardReader::copy_row(const KnotCopy& knot, std::span<double> g) const noexcept {
  const Word* const row =
      slot_at(knot.slot) + (layout_.rows + row_of(knot.tag) * layout_.row) / sizeof(Word);
  const auto value = [row](std::size_t i) {
    return to_double(load(row[i], std::memory_order_relaxed));
  };
  for (std::size_t d = 0; d < g.size(); ++d) g[d] = value(kRowG + d);
  core::Prefix prefix{.gamma = value(kRowGamma)};
  const std::size_t factors = kRowG + layout_.dimensions;
  if (layout_.smooths) {
    prefix.smoothing = {value(factors), value(factors + 1), value(factors + 2)};
  }
  return prefix;
}

}  // namespace splinecast::ipc
