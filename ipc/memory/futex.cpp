#include "ipc/memory/futex.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <bit>
#include <climits>
#include <cstdint>
#include <ctime>

#include "splinecast/clock.hpp"

namespace splinecast::ipc {

static_assert(std::endian::native == std::endian::little);

namespace {

timespec to_timespec(Time time) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t bounded = time.count() > 0 ? time.count() : 0;
  return {.tv_sec = bounded / kSecond, .tv_nsec = bounded % kSecond};
}

/// The FUTEX_WAIT_BITSET bit of threads that have seen `revision` and wait for a later one. It
/// distinguishes them from threads that have seen only an earlier revision.
std::uint32_t bit_of(Word revision) noexcept { return std::uint32_t{1} << revision % 32; }

}  // namespace

void wait_while_equal(const Word& word, Word seen, Time timeout) noexcept {
  const timespec relative = to_timespec(timeout);
  syscall(SYS_futex, &word, FUTEX_WAIT, static_cast<std::uint32_t>(seen), &relative, nullptr, 0);
}

bool wait_for_change(const Word& revision, Word seen, Time timeout) noexcept {
  const timespec end = to_timespec(deadline(MonotonicClock(), timeout));
  const bool is_woken = syscall(SYS_futex, &revision, FUTEX_WAIT_BITSET,
                                static_cast<std::uint32_t>(seen), &end, nullptr, bit_of(seen)) == 0;
  if (is_woken) {
    // Does not wake threads that have seen the current revision: woken threads would wake each
    // other forever.
    const Word present = load(revision, std::memory_order_relaxed);
    syscall(SYS_futex, &revision, FUTEX_WAKE_BITSET, kWokenAtOnce, nullptr, nullptr,
            ~bit_of(present));
  }
  return is_woken;
}

int wake_some(const Word& revision) noexcept {
  // No bit set is needed: all waiting threads wait for this revision or an earlier one.
  return static_cast<int>(
      syscall(SYS_futex, &revision, FUTEX_WAKE, kWokenAtOnce, nullptr, nullptr, 0));
}

void wake_all(const Word& word) noexcept {
  syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace splinecast::ipc
