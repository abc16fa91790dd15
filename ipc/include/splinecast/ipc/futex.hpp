#pragma once

#include "splinecast/core/time.hpp"
#include "splinecast/ipc/word.hpp"

namespace splinecast::ipc {

/// Sleeps until `word` differs from `seen` or the timeout has passed; also returns early for no
/// reason, so callers look again. A read-only mapping is enough: the kernel only compares. Only
/// the low 32 bits take part, which lie first on the little-endian hosts this builds for; a word
/// that moves on by 2³² between the look and the sleep would be missed, and the timeout bounds it.
/// std::atomic::wait would not do: it parks on a process-private address.
void wait_while_equal(const Word& word, Word seen, core::Time timeout) noexcept;

/// Wakes every process that waits on `word`. One system call.
void wake_all(const Word& word) noexcept;

}  // namespace splinecast::ipc
