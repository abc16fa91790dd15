#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::fuzz {

/// A broken promise, which a fuzzer reports.
class Broken : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void require(bool holds, const char* promise) {
  if (!holds) throw Broken(promise);
}

/// Reads numbers from a script in order; zeros after its end.
class Script {
 public:
  explicit Script(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool has_ended() const { return at_ >= bytes_.size(); }
  std::uint8_t byte() { return has_ended() ? std::uint8_t{0} : bytes_[at_++]; }
  std::size_t below(std::size_t limit) { return (byte() * std::size_t{256} + byte()) % limit; }
  ipc::Word word() {
    ipc::Word value = 0;
    for (int i = 0; i < 8; ++i) value = value << 8U | byte();
    return value;
  }
  /// A time near t, or any time.
  Time near(Time t) {
    const auto choice = byte();
    if (choice == 255) return ipc::to_time(word());
    const auto offset = static_cast<std::int8_t>(byte());
    return ipc::to_time(ipc::to_word(t) +
                        static_cast<ipc::Word>(std::int64_t{offset} << choice % 32U));
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace splinecast::fuzz
