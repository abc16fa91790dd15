#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "splinecast/ipc/word.hpp"

/// Publication: how one writer makes many words visible at once, and any number of readers copy
/// them whole, without waiting for anybody.
///
/// A *slot* has two *cells*; word 0 of a cell is its *tag*, the number of the revision that wrote
/// it. The newest cell under revision r is the one with the largest tag ≤ r; the other one is the
/// spare. A revision writes the spare cell of every slot that it changes and then stores its number
/// to the *commit word*: only that store makes it visible, all of it at once.
///
/// Orderings, as checked with a model checker for C11 under RC11 and IMM with crashes at every
/// store (none of the failures can show on x86, nor under ThreadSanitizer; all are real on other
/// machines):
///
/// W1 tag[c].store(r+1, release), first. It must come before the words: a reader that copies a new
///    word (acquire) must not afterwards still see the old tag, else it would keep a torn copy.
///    Release, because of the *previous* revision in the other cell: a reader with an older r finds
///    this tag too new and takes the other cell. Let its old tag be all that it has seen of that:
///    having acquired this tag it must find there, in R3 or R4, that it has been written since.
/// W2 word[c].store(release), each. Pairs with R3: who reads a new word also sees W1, so that R4
///    finds the new tag.
/// W3 commit.store(r+1, release). Pairs with R1: who sees the revision sees its tags and words.
/// R1 commit.load(acquire). Pairs with W3.
/// R2 both tags load(acquire). Pairs with W1, or T1, of a later revision, and keeps R3 behind R2.
/// R3 word[c].load(acquire), each. Pairs with W2, and keeps R4 behind R3.
/// R4 tag[c].load(relaxed), directly after the copy: still the tag of R2, or the copy is thrown
///    away. Relaxed is enough: R3 has ordered it, and nothing after it depends on it.
/// K1 A copy made under an older revision may be used under r without copying it again. First the
///    tag of the other cell, load(acquire), must not lie in (copy's tag, r].
/// K2 Then the tag of the copy's own cell, load(relaxed), must still be the copy's. Let q be the
///    first revision up to r that wrote the slot after the copy was made. It wrote the other cell,
///    and R1 has made that visible: K1 finds q, and the copy is not kept, or finds a later tag
///    above r. A later revision writes the other cell only after one in between has written the
///    copy's own cell; that store precedes the later tag, which K1 acquired (W1, T1), so K2 sees
///    it. It is not enough to compare both tags as if they had been loaded at one instant, nor to
///    load the own tag before the other one: two revisions may pass between the two loads.
/// T1 takeover: the new writer overwrites every tag above the commit word with kRetiredTag
///    (release) before it writes anything: a half-written cell of the dead writer must never come
///    to be the newest when the numbers reach its tag. Release for the same reason as W1. The same
///    is done with a revision that its own writer discards.
/// W0 what the writer loads of tags and words is relaxed: its own stores, or those of a dead writer
///    whose lock the kernel gave to it afterwards.
///
/// There are no fences, no read-modify-writes, and readers store nothing.
namespace splinecast::ipc {

/// A tag that no revision reaches.
inline constexpr Word kRetiredTag = std::numeric_limits<Word>::max();

/// The two tags of a slot, as seen once.
struct Tags {
  std::array<Word, 2> of;

  /// The cell that is newest under revision r; may itself be newer than r: see holds_any.
  [[nodiscard]] std::size_t newest(Word r) const noexcept {
    return of[1] <= r && (of[0] > r || of[1] > of[0]) ? 1 : 0;
  }
  /// Whether either cell was written at or before revision r. Tag 0 is never written.
  [[nodiscard]] bool holds_any(Word r) const noexcept {
    const Word tag = of[newest(r)];
    return tag != 0 && tag <= r;
  }
};

/// A slot's words: two cells of `cell_words` words each, one after the other.
template <typename WordType>
struct SlotView {
  WordType* words;
  std::size_t cell_words;

  [[nodiscard]] WordType* cell(std::size_t c) const noexcept { return words + c * cell_words; }

  [[nodiscard]] Tags tags(std::memory_order order) const noexcept {
    return {{load(cell(0)[0], order), load(cell(1)[0], order)}};
  }
};

/// W1: claims the spare cell of a slot for revision `r`, of which `r − 1` is committed. Returns the
/// cell, to be filled from word 1 on with W2 stores. May be called again for the same r.
[[nodiscard]] inline Word* claim_spare(const SlotView<Word>& slot, Word r) noexcept {
  const Tags tags = slot.tags(std::memory_order_relaxed);  // W0
  Word* const spare = slot.cell(1 - tags.newest(r - 1));
  store(spare[0], r, std::memory_order_release);
  return spare;
}

/// W2 for one word.
inline void put(Word& word, Word value) noexcept { store(word, value, std::memory_order_release); }

/// K1 and K2: whether what was copied from cell `c`, with `tag`, is what the slot holds under
/// revision `r` ≥ `tag` too. Two loads. Where words of that cell were loaded (acquire) before the
/// call, true also says that these are of the revision `tag` (R4).
[[nodiscard]] inline bool is_newest(const SlotView<const Word>& slot, std::size_t c, Word tag,
                                    Word r) noexcept {
  const Word other = load(slot.cell(1 - c)[0], std::memory_order_acquire);
  if (other > tag && other <= r) return false;
  return load(slot.cell(c)[0], std::memory_order_relaxed) == tag;
}

/// T1 for one slot: retires what no commit has made visible.
inline void retire_uncommitted(const SlotView<Word>& slot, Word committed) noexcept {
  for (std::size_t c = 0; c < 2; ++c) {
    Word& tag = slot.cell(c)[0];
    if (load(tag, std::memory_order_relaxed) > committed) {
      store(tag, kRetiredTag, std::memory_order_release);
    }
  }
}

/// Copies words 1 … `count` of the cell that is newest under revision `r` (R2–R4). Returns its tag,
/// or 0 if the slot holds nothing under r or was written meanwhile: then `out` is of no use.
/// Wait-free: 3 + count loads.
[[nodiscard]] inline Word copy_newest(const SlotView<const Word>& slot, Word r, std::size_t count,
                                      Word* out) noexcept {
  const Tags tags = slot.tags(std::memory_order_acquire);
  if (!tags.holds_any(r)) return 0;
  const std::size_t c = tags.newest(r);
  const Word* const cell = slot.cell(c);
  for (std::size_t i = 0; i < count; ++i) out[i] = load(cell[1 + i], std::memory_order_acquire);
  return load(cell[0], std::memory_order_relaxed) == tags.of[c] ? tags.of[c] : 0;
}

}  // namespace splinecast::ipc
