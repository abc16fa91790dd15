#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Sleeps until `word` differs from `seen` or the timeout has passed. May return early (spurious
/// wake-up): callers check again. A read-only mapping is enough, because the kernel only compares.
/// Compares the low 32 bits only, which come first on the little-endian hosts that this builds for;
/// a change by a multiple of 2³² between load and sleep is missed until the timeout.
/// std::atomic::wait does not work here: it uses a process-private futex.
void wait_while_equal(const Word& word, Word seen, Time timeout) noexcept;

/// Wakes all threads that wait on `word`. One system call, which takes about 4 µs per waiting
/// thread: do not use it for a word on which any number of readers may wait.
void wake_all(const Word& word) noexcept;

/// The maximum number of threads that one call of wake_some() wakes, and that one woken thread
/// wakes in wait_for_change().
inline constexpr int kWokenAtOnce = 8;

/// Wakes at most kWokenAtOnce threads that wait on `revision`: one system call, of bounded cost for
/// any number of waiting threads. Threads in `wait_for_change` wake the others. Returns how many it
/// woke.
int wake_some(const Word& revision) noexcept;

/// Like wait_while_equal, for the commit word of a board. A woken thread wakes up to kWokenAtOnce
/// other threads that still wait for a revision before the current one; each of these does the
/// same. So all threads wake in a logarithmic number of rounds, each makes one system call, and
/// none is woken twice for one revision. A thread that waits on the word with another function, or
/// that dies when it is woken, wakes no other thread. The threads that are left sleep until their
/// timeout, so the timeout must bound this delay. Returns whether the thread was woken, by a
/// revision or spuriously by another process. Returns false after the timeout or a signal, and also
/// if `revision` already differed from `seen`: load it again.
bool wait_for_change(const Word& revision, Word seen, Time timeout) noexcept;

}  // namespace splinecast::ipc
