#include "splinecast/ipc/futex.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <bit>
#include <climits>
#include <cstdint>
#include <ctime>

namespace splinecast::ipc {

static_assert(std::endian::native == std::endian::little);

void wait_while_equal(const Word& word, Word seen, core::Time timeout) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t bounded = timeout.count() > 0 ? timeout.count() : 0;
  const timespec relative{.tv_sec = bounded / kSecond, .tv_nsec = bounded % kSecond};
  syscall(SYS_futex, &word, FUTEX_WAIT, static_cast<std::uint32_t>(seen), &relative, nullptr, 0);
}

void wake_all(const Word& word) noexcept {
  syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace splinecast::ipc
