#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Sleeps until `word` differs from `seen` or the timeout has passed; also returns early for no
/// reason, so callers look again. A read-only mapping is enough: the kernel only compares. Only
/// the low 32 bits take part, which lie first on the little-endian hosts this builds for; a word
/// that moves on by 2³² between the look and the sleep would be missed, and the timeout bounds it.
/// std::atomic::wait would not do: it parks on a process-private address.
void wait_while_equal(const Word& word, Word seen, Time timeout) noexcept;

/// Wakes every process that waits on `word`. One system call, whose cost grows with how many wait
/// (about 4 µs each): not for a writer that any number of readers may wait for.
void wake_all(const Word& word) noexcept;

/// The largest number of threads that one call wakes for a revision.
inline constexpr int kWokenAtOnce = 8;

/// Wakes at most kWokenAtOnce threads that wait on `revision`: one system call of bounded cost,
/// however many wait. Those that wait by `wait_for_change` wake the others. Returns how many.
int wake_some(const Word& revision) noexcept;

/// As wait_while_equal, on the commit word of a board. A thread that is woken then wakes up to
/// kWokenAtOnce others that still wait for a revision before the present one, and so on: all are
/// woken in a logarithmic number of rounds, with one system call each, and nobody twice for one
/// revision. A thread that waits on the word in another way, or dies when woken, wakes nobody, and
/// those behind it sleep until their timeout: choose one that bounds this delay. Returns whether it
/// was woken, by a revision or spuriously by another process.
bool wait_for_change(const Word& revision, Word seen, Time timeout) noexcept;

}  // namespace splinecast::ipc
