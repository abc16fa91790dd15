#include <algorithm>
#include <array>
#include <limits>

#include "ipc/board/reader.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

/// Whether the knots of a summary can all be on a board and its times are valid. Always true for
/// what a solver writes.
bool has_sane_bounds(const Summary& summary, std::size_t capacity) noexcept {
  if (!is_time_in_range(summary.settled_until)) return false;
  if (summary.newest == 0) return true;
  return summary.first >= 1 && summary.first <= summary.newest &&
         summary.newest - summary.first < capacity &&
         summary.newest <= std::numeric_limits<Word>::max() / 2 && summary.stop >= Time::zero() &&
         summary.stop <= kLongestStop;
}

}  // namespace

/// C2: the earliest time from which the revisions after `seen` up to r changed the curve; min() if
/// some of their words have been overwritten.
Time KnotBoardReader::earliest_change(Word seen, Word r) const noexcept {
  const Word missed = r - seen;  // huge if the commit word decreased, which no solver does
  if (missed >= kChangesKept) return Time::min();
  Time earliest = Time::max();
  for (Word back = 0; back < missed; ++back) {
    const Word& word = control_[kChanges + (r - back) % kChangesKept];
    earliest = std::min(earliest, to_time(load(word, std::memory_order_acquire)));
  }
  // C3. At most N − 1 of the N words are valid, because a writer that died may have stored the next
  // one. If both tags are retired, it is unknown how far writers have advanced.
  const Tags tags = summary_cells().tags(std::memory_order_acquire);
  bool is_found = false;
  for (const Word tag : tags.of) {
    if (tag == kRetiredTag) continue;
    if (revision_of(tag) > seen + kChangesKept - 1) return Time::min();
    is_found = true;
  }
  return is_found ? earliest : Time::min();
}

bool KnotBoardReader::copy_bounds(const Look& look, Word seen, Summary& out) const noexcept {
  const Word r = look.revision;
  const Time changed_from = earliest_change(seen, r);
  const auto view = summary_cells();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  const Word* const cell = view.cell(c);
  std::array<Word, kBoundsWords> words{};
  for (std::size_t i = 1; i < words.size(); ++i) {
    words[i] = load(cell[i], std::memory_order_acquire);
  }
  if (load(cell[0], std::memory_order_relaxed) != tags.of[c]) return false;
  Summary bounds;
  decode(kBoundsRows, words.data(), bounds);
  bounds.settled_until = look.settled_until;
  if (!has_sane_bounds(bounds, layout_.capacity)) return false;
  decode(kBoundsRows, words.data(), out);
  out.revision = r;
  out.settled_until = look.settled_until;
  out.changed_from = changed_from;
  return true;
}

Time KnotBoardReader::refused_until(Word r) const noexcept {
  constexpr std::size_t kWord = word_of(kSummaryFields, "refused until");
  const auto view = summary_cells();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return Time::max();
  const std::size_t c = tags.newest(r);
  const Time time = to_time(load(view.cell(c)[kWord], std::memory_order_acquire));
  const bool is_whole = load(view.cell(c)[0], std::memory_order_relaxed) == tags.of[c];
  return is_whole ? time : Time::max();
}

bool KnotBoardReader::copy_summary(const Look& look, Summary& out) const noexcept {
  const Word r = look.revision;
  const Time changed_from = earliest_change(r - 1, r);
  const auto view = summary_cells();
  const Tags tags = view.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return false;
  const std::size_t c = tags.newest(r);
  std::array<Word, kSummaryWords> words{};
  for (std::size_t i = 1; i < words.size(); ++i) {
    words[i] = load(view.cell(c)[i], std::memory_order_acquire);
  }
  if (load(view.cell(c)[0], std::memory_order_relaxed) != tags.of[c]) return false;
  Summary summary;
  decode(kSummaryRows, words.data(), summary);
  summary.revision = r;
  summary.settled_until = look.settled_until;
  summary.changed_from = changed_from;
  if (!has_sane_bounds(summary, layout_.capacity) || !is_time_in_range(summary.newest_time) ||
      !is_time_in_range(summary.committed)) {
    return false;
  }
  const bool is_late = r > 0 && load(control_[kLate], std::memory_order_relaxed) == r;
  summary.late_commits += is_late ? 1 : 0;
  out = summary;
  return true;
}

bool KnotBoardReader::copy_newest_summary(Summary& out) const noexcept {
  constexpr int kTries = 16;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Look seen = look();
    if (seen.revision == 0) return false;
    if (copy_summary(seen, out)) return true;
  }
  return false;
}

bool KnotBoardReader::copy_table(std::span<const Word> tables, std::span<Word> out) const noexcept {
  constexpr int kTries = 16;
  for (int attempt = 0; attempt < kTries && !tables.empty(); ++attempt) {
    const Word r = revision();
    const auto view = summary_cells();
    const Tags tags = view.tags(std::memory_order_acquire);
    if (r == 0 || !tags.holds_any(r)) continue;
    const std::size_t c = tags.newest(r);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = load(tables[c * out.size() + i], std::memory_order_acquire);
    }
    if (load(view.cell(c)[0], std::memory_order_relaxed) == tags.of[c]) return true;
  }
  return false;
}

}  // namespace splinecast::ipc
