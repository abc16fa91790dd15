#pragma once

#include <array>
#include <optional>
#include <span>

#include "ipc/layout/request_control.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// What a commander of a time law requests, as its region has it.
namespace splinecast::ipc {

/// Shortest and longest ramp, and dead man.
inline constexpr Time kShortestRamp{1'000'000};
inline constexpr Time kLongestRamp{3'600'000'000'000};

/// Length of the ramp to rate 0 after a dead man has expired, unless the commander names another.
inline constexpr Time kDeadManRamp{500'000'000};

/// What a commander requests.
struct RateCommand {
  Word number = 0;          ///< of the request; 0: none yet
  Time time = Time::min();  ///< host time at which it was made or last renewed
  double rate = -1;         ///< requested rate, at least 0; below 0: none
  Time ramp = kShortestRamp;
  Time dead_man{};  ///< after this time without a renewal, the rate is 0; 0: never
  Time dead_man_ramp = kDeadManRamp;
};

/// The words of a command, and the command in words. Nothing if a value is not finite or out of
/// range: any process that may write the region can have stored it.
[[nodiscard]] std::array<Word, kCommanderRecordWords> words_of(const RateCommand& command) noexcept;
[[nodiscard]] std::optional<RateCommand> command_of(
    const std::array<Word, kCommanderRecordWords>& words) noexcept;

/// Writes a command to the control block of its region. Wait-free.
void write_command(std::span<Word> control, const RateCommand& command) noexcept;

}  // namespace splinecast::ipc
