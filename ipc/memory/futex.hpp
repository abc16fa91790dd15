#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Sleeps until `word` differs from `seen` or the timeout has passed. May return early (spurious
/// wake-up): callers check again. A read-only mapping is enough, because the kernel only compares.
/// Compares the low 32 bits only, which come first on the little-endian hosts that this builds for;
/// a change by a multiple of 2³² between load and sleep is missed until the timeout.
/// std::atomic::wait does not work here: it waits on a process-private address.
void wait_while_equal(const Word& word, Word seen, Time timeout) noexcept;

/// Wakes all threads that wait on `word`. One system call of about 4 µs per waiting thread: not for
/// a writer on whose word any number of readers may wait.
void wake_all(const Word& word) noexcept;

/// The largest number of threads that one call wakes for a revision.
inline constexpr int kWokenAtOnce = 8;

/// Wakes at most kWokenAtOnce threads that wait on `revision`: one system call, of bounded cost for
/// any number of waiting threads. Threads in `wait_for_change` wake the others. Returns how many it
/// woke.
int wake_some(const Word& revision) noexcept;

/// Like wait_while_equal, on the commit word of a board. A woken thread wakes up to kWokenAtOnce
/// others that still wait for a revision before the current one, and so on: all wake in a
/// logarithmic number of rounds, with one system call each, and none twice for one revision. A
/// thread that waits on the word in another way, or dies when woken, wakes no other thread; those
/// left sleep until their timeout, which must bound this delay. Returns whether it was woken, by a
/// revision or spuriously by another process.
bool wait_for_change(const Word& revision, Word seen, Time timeout) noexcept;

}  // namespace splinecast::ipc
