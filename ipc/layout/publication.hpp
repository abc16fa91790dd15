#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "ipc/memory/word.hpp"

/// Publication: how one writer makes many words visible at once, and any number of readers copy
/// them consistently, without waiting.
///
/// A *slot* has two *cells* and two *nodes*. A node holds the inputs of a knot (time, position), a
/// cell the results of each solve (velocity). Word 0 of a cell is its *tag*: the revision that
/// wrote it, and bits that describe the knot, one of which names its node. A comparison of a tag
/// with a revision uses only the tag's revision. The *newest* cell under revision r is the one with
/// the greatest revision ≤ r; the other one is the *spare*. In each slot that it changes, a
/// revision writes the spare cell; if a new knot takes the slot, it also writes the node that the
/// newest cell does not name. Then it stores its number to the *commit word*, which makes all of it
/// visible at once. The summary is a slot without nodes.
///
/// Each "fails" below is an execution that a model has found: [s] the spin model of tests/model, by
/// plain interleaving, so that it can happen on x86 too; [m] only a weaker memory model (RC11,
/// IMM), so that neither x86 nor ThreadSanitizer shows it.
///
/// Writer
///
/// W0 The writer loads tags and words relaxed: they are its own stores, or those of a dead writer
///    whose lock the kernel released before this writer got it.
/// W1 tag[c].store((r+1, node), release), first, before node and cell.
///    First, because a reader that copies a new word (R3) must not find the old tag at R4. The same
///    covers the node: it is overwritten only when no cell with a valid tag names it. The newest
///    cell names the other node; the spare's tag may name this one, but W1 has overwritten it.
///    Fails: the tag after the cell [s]; the node before the tag [s], where a slot gets a new knot
///    twice in a row: revisions 1 and 3 use the same cell and node, and a reader under 1 takes the
///    time of knot 3 with the tag of knot 1.
///    Release, because of the *previous* revision q in the other cell. A reader under an older
///    revision finds the new tag too new and takes the other cell. It may have loaded that cell's
///    tag before q overwrote it. Having acquired the new tag, it knows that q has claimed that
///    cell, so R4 sees q's tag or a later one and rejects the copy [m].
/// W2 node[m] and cell[c].store(release), each word. Pairs with R3: a reader that loads a new word
///    also sees W1, so that R4 finds the new tag [m]. Cell and node may be stored in either order.
/// W3 commit.store(r+1, release). Pairs with R1: a reader that sees the revision sees its tags,
///    cells, nodes and ring word [m].
/// T1 Takeover: before its first other store, the successor overwrites every tag above the commit
///    word with kRetiredTag (release). A writer that discards its own revision does the same. Else
///    a half-written cell becomes the newest when the commit word reaches its tag; this fails where
///    the successor does not write that slot [s].
///    The retired tag is above each revision. 0 is not: C3 would count two retired tags as old ones
///    (fails [s]). A reader that takes 0 as the tag of older history fails, too, where its newest
///    cell is being overwritten [s]. But copies of slots reject tag 0, as of a cell that was never
///    written: for slots alone 0 would do.
///    Release for the same reason as W1: a reader that finds the retired tag takes the other cell,
///    and must then see at R4 whether that cell was overwritten before [m].
///    A retired tag names no node: the writer takes the node bit from the newest *committed* cell
///    only [s].
///
/// Reader
///
/// R1 commit.load(acquire). Pairs with W3.
/// R2 Both tags, load(acquire). Pairs with W1 or T1 of a later revision, and keeps R3 after R2.
/// R3 cell[c] and node[tag's node].load(acquire), each word, in either order. Pairs with W2, and
///    keeps R4 after R3.
/// R4 tag[c].load(relaxed), directly after the copies: still the tag of R2, all 64 bits, else the
///    copy is rejected. Relaxed is enough: R3 has ordered it, and nothing after it depends on it.
///    One check covers cell and node.
///
/// The two knots of a segment are copied in sequence under the same r. Each copy is exactly the
/// knot under r, so that the first need not be checked again after the second.
///
/// Kept copies: a copy with tag T may be used under r' ≥ the revision that it was made under, iff
///
/// K1 tag[1 − c].load(acquire) is not in (T, r'], and then
/// K2 tag[c].load(relaxed), after K1, is still T.
///
/// Let q be the first revision after the copy's, up to r', that wrote the slot. It wrote the other
/// cell, and R1 has made that visible. Either K1 finds q: rejected. Or K1 finds a later tag, which
/// is above r' or retired. A later revision q' claims the other cell only after a revision in
/// between has claimed the copy's own cell. That claim precedes the store of the tag of q' and the
/// store that retires this tag. Both are release, and K1 has acquired one of them, so K2 sees that
/// the copy's cell was overwritten: rejected. K1 relaxed fails [m]. Not enough [s]: only the own
/// tag (q does not change it); the own tag loaded before the other one; both tags loaded in the
/// order of storage and compared as if loaded at one instant (two revisions pass between the two
/// loads). When the tag has changed, cell and node are both copied again: the node bit does not
/// identify a knot, because after two new knots it has the same value again [s].
///
/// Ring of changes: word r mod N holds the time from which revision r changed the curve.
///
/// C1 Word r is stored (release) after the summary's spare tag has been claimed for r (W1) and
///    before the commit (W3).
/// C2 A reader that saw revision `seen` and now reads under r loads words seen+1 … r (acquire),
///    after R1. R1 guarantees that each is the word of its revision or of one N, 2N, … later.
/// C3 Then it loads both tags of the summary (relaxed is enough; after C2). Let g be the greatest
///    tag that is not retired. The words are valid iff there is such a tag and g ≤ seen + N − 1.
///    Otherwise everything counts as changed.
///
/// Why: suppose that a loaded word is of a later revision m ≥ seen + 1 + N. C2 acquires C1, and so
/// the claim of the summary's tag for m, and the claim of m − 1 in the other cell, which was
/// committed. So each tag that C3 loads is the claim in its cell, a later one, or retired. If one
/// of the two is not retired, g ≥ m − 1 ≥ seen + N: the words are not valid.
/// - N − 1, not N: the writer may die after storing word m; its successor retires tag m, and g is
///   m − 1 [s]. If no tag is ever retired, N is correct too.
/// - If both tags are retired, the words must not count as valid [s]: writer 1 dies with m claimed,
///   its tag is retired, the reader loads that tag; the successor commits m, claims m+1 in the
///   other cell and dies; its successor retires that; the reader loads that tag. Both are retired
///   although m is committed. Two discards by a living writer have the same effect.
/// - Tag before word: if word m is stored first, C2 knows only of the tags up to m − 1. A reader
///   then loads the tag m − 2 in the cell that m is about to claim, and, after m and m + 1, finds
///   m + 1 retired in the other: g = m − 2 [s].
/// - Words before tags: a tag loaded before the words says nothing about what overwrote them
///   afterwards [s].
/// - C1 and C2 relaxed fail [m]: C3 then need not see the claim that precedes the word. C3 needs no
///   acquire, and the release of W1 and T1 is not needed for the ring: C1 carries the claim.
///
/// Settled word: one word next to the commit word. It promises that no later revision changes
/// anything before it.
///
/// S1 settled.store(s, release), after the commit (W3) of the revision to which s belongs. It may
///    be raised later without a revision; every later revision then begins at or after it. It never
///    decreases, except on a stream that a time law holds: see StreamSolver.
/// S2 settled.load(acquire), before R1 (acquire). Pairs with S1: a reader that sees s sees, at R1,
///    the revision to which s belongs or a later one. No revision after that changes anything
///    before s, so the curve before s under r is final.
///
/// - The settled word loaded after the commit word fails [s]: between the two loads a revision
///   changes the curve before s, is committed, and s is stored. The reader calls the old curve
///   settled.
/// - Stored before the commit it fails in the same way [s]: the reader takes s with the older
///   revision.
/// - S1 or S2 relaxed fails [m]: R1 may then load a revision older than the one to which s belongs.
///   (W3 and R1 are not needed for this pair alone: S1 carries the commit.)
/// - A successor continues from the settled word and the commit word that it finds. Starting from
///   an earlier settled time fails [s]: the successor changes what its predecessor promised. If the
///   predecessor died between W3 and S1, the word is lower than it could be, which is safe.
/// - A reader may use an s that it loaded earlier with a newer revision, but never a newer s with
///   an older revision: after each reload of the settled word, it does R1 before it uses s.
///
/// There are no fences, no read-modify-writes, and readers store nothing.
namespace splinecast::ipc {

/// The upper 47 bits of a tag are its revision; the lower bits describe the cell.
inline constexpr unsigned kTagRevisionShift = 17;

/// The tag of a retired cell: above the tag of every revision.
inline constexpr Word kRetiredTag = std::numeric_limits<Word>::max();

/// One less than the last revision that a tag can hold: reached after 4.4 years at a million
/// revisions per second.
inline constexpr Word kLastRevision = (kRetiredTag >> kTagRevisionShift) - 2;

[[nodiscard]] constexpr Word revision_of(Word tag) noexcept { return tag >> kTagRevisionShift; }

/// The two tags of a slot, each loaded once.
struct Tags {
  std::array<Word, 2> of;

  /// The cell that is newest under revision r: 0 or 1. If both are newer than r, there is none, and
  /// the result is 0: see holds_any.
  [[nodiscard]] std::size_t newest(Word r) const noexcept {
    const Word r0 = revision_of(of[0]);
    const Word r1 = revision_of(of[1]);
    return r1 <= r && (r0 > r || r1 > r0) ? 1 : 0;
  }
  /// Whether a cell was written at or before revision r. Tag 0 means that the cell was never
  /// written.
  [[nodiscard]] bool holds_any(Word r) const noexcept {
    const Word tag = of[newest(r)];
    return tag != 0 && revision_of(tag) <= r;
  }
};

/// The contiguous cells of a slot: `cell_words` words each, of which the first is the tag.
template <typename WordType>
struct SlotView {
  WordType* words;
  std::size_t cell_words;

  [[nodiscard]] WordType* cell(std::size_t c) const noexcept { return words + c * cell_words; }

  [[nodiscard]] Tags tags(std::memory_order order) const noexcept {
    return {{load(cell(0)[0], order), load(cell(1)[0], order)}};
  }
};

/// Stores one word with release, as W2 requires.
inline void put(Word& word, Word value) noexcept { store(word, value, std::memory_order_release); }

/// K1 and K2: whether a copy of cell `c`, made with `tag`, is also what the slot holds under
/// revision `r`, which is that of the tag or later. Two loads. If words of that cell, or of its
/// node, were loaded (acquire) before the call, true also means that they belong to the tag (R4).
[[nodiscard]] inline bool is_newest(const SlotView<const Word>& slot, std::size_t c, Word tag,
                                    Word r) noexcept {
  const Word other = revision_of(load(slot.cell(1 - c)[0], std::memory_order_acquire));
  if (other > revision_of(tag) && other <= r) return false;
  return load(slot.cell(c)[0], std::memory_order_relaxed) == tag;
}

/// T1 for one slot: retires each tag above the commit word.
inline void retire_uncommitted(const SlotView<Word>& slot, Word committed) noexcept {
  for (std::size_t c = 0; c < 2; ++c) {
    Word& tag = slot.cell(c)[0];
    if (revision_of(load(tag, std::memory_order_relaxed)) > committed) {
      store(tag, kRetiredTag, std::memory_order_release);
    }
  }
}

}  // namespace splinecast::ipc
