#include "ipc/law/commander_record.hpp"

#include <cmath>

#include "ipc/layout/header.hpp"
#include "ipc/requests/record.hpp"

namespace splinecast::ipc {
namespace {

bool is_ramp(Time time) noexcept { return time >= kShortestRamp && time <= kLongestRamp; }

}  // namespace

std::array<Word, kCommanderRecordWords> words_of(const RateCommand& command) noexcept {
  return {command.number,        to_word(command.time),     to_word(command.rate),
          to_word(command.ramp), to_word(command.dead_man), to_word(command.dead_man_ramp)};
}

std::optional<RateCommand> command_of(
    const std::array<Word, kCommanderRecordWords>& words) noexcept {
  const RateCommand command{.number = words[0],
                            .time = to_time(words[1]),
                            .rate = to_double(words[2]),
                            .ramp = to_time(words[3]),
                            .dead_man = to_time(words[4]),
                            .dead_man_ramp = to_time(words[5])};
  const bool is_rate = command.rate == -1 || (command.rate >= 0 && command.rate <= kLargestRate);
  const bool has_dead_man = command.dead_man == Time::zero() || is_ramp(command.dead_man);
  const bool is_valid = command.number > 0 && command.time >= Time::zero() && is_rate &&
                        is_ramp(command.ramp) && has_dead_man && is_ramp(command.dead_man_ramp);
  return is_valid ? std::optional(command) : std::nullopt;
}

void write_command(std::span<Word> control, const RateCommand& command) noexcept {
  write_record(control, words_of(command));
}

}  // namespace splinecast::ipc
