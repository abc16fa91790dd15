#include "ipc/law/commander_record.hpp"

#include <cmath>

#include "ipc/layout/header.hpp"

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
  Word& sequence = control[kCommanderSequence];
  const Word odd = load(sequence, std::memory_order_relaxed) | 1;
  store(sequence, odd, std::memory_order_relaxed);
  const auto words = words_of(command);
  for (std::size_t i = 0; i < words.size(); ++i) {
    store(control[kCommanderNumber + i], words[i], std::memory_order_release);
  }
  store(sequence, odd + 1, std::memory_order_release);
}

CommandCopy copy_command(std::span<const Word> control) noexcept {
  constexpr int kTries = 4;
  CommandCopy copy;
  for (int i = 0; i < kTries && !copy.is_whole; ++i) {
    copy.sequence = load(control[kCommanderSequence], std::memory_order_acquire);
    for (std::size_t k = 0; k < copy.words.size(); ++k) {
      copy.words[k] = load(control[kCommanderNumber + k], std::memory_order_acquire);
    }
    copy.is_whole = copy.sequence % 2 == 0 &&
                    load(control[kCommanderSequence], std::memory_order_relaxed) == copy.sequence;
  }
  return copy;
}

}  // namespace splinecast::ipc
