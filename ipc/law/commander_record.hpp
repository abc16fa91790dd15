#pragma once

#include <array>
#include <optional>
#include <span>

#include "ipc/layout/commander_control.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// The latest state of a law's commander, in its region: one record under a sequence counter.
///
/// One writer, any number of readers that store nothing. The sequence is even while the record is
/// whole.
///
/// Q1 The writer stores the next odd sequence (relaxed), each word of the record (release), and the
///    next even sequence (release). An earlier writer may have died in between: a sequence that is
///    found odd stays odd while the words are written.
/// Q2 A reader loads the sequence (acquire), each word of the record (acquire), and the sequence
///    again (relaxed). The copy is whole iff both are the same even number.
///
/// Why: the first load acquires the last store of that sequence's writer, so each word is at least
/// as new as that. A word of a later record is stored with release after its odd sequence; a reader
/// that loads that word with acquire finds this sequence or a later one in its second load. A
/// sequence repeats only after 2⁶³ requests.
///
/// Not enough (found by the model, tests/model/commander_record.pml): one sequence that is stored
/// before the words only, or after them only; a reader that compares the sequences but takes an odd
/// one.
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

/// Writes a command: Q1. `control` is the control block of the region. Wait-free.
void write_command(std::span<Word> control, const RateCommand& command) noexcept;

/// A copy of a record: Q2.
struct CommandCopy {
  Word sequence = 0;
  bool is_whole = false;  ///< no writer was seen in between
  std::array<Word, kCommanderRecordWords> words{};
};

/// Copies the record in a bounded number of tries.
[[nodiscard]] CommandCopy copy_command(std::span<const Word> control) noexcept;

}  // namespace splinecast::ipc
