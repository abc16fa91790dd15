#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/laws/rate_curve.hpp"
#include "core/laws/rate_plan.hpp"
#include "ipc/law/commander_record.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// A commander as its law's board has it: a row of the table of commanders.
struct CommanderEntry {
  Word id = 0;                                   ///< stream id of its region; 0: the slot is free
  std::array<char, kCommanderNameBytes> name{};  ///< its name, or the beginning of a longer one
  Word number = 0;                               ///< of its newest request
  bool asks = false;                             ///< it requests a rate
  bool is_dead = false;                          ///< the dead man of that request has fired
  bool is_damaged = false;                       ///< its region holds no whole request any more
  Time renewed{};                                ///< when it made or renewed the request
  Time ramp = kShortestRamp;                     ///< that it requests
  core::RateCurve bound{1};                      ///< ends at the rate that it requests
};

/// The words of an entry; and the entry in words. Nothing if the slot is free, or if a value is not
/// one that a solver of a law with this largest rate writes.
void write_entry(const CommanderEntry& entry, std::span<Word, kCommanderWords> to) noexcept;
[[nodiscard]] std::optional<CommanderEntry> entry_of(std::span<const Word, kCommanderWords> words,
                                                     double largest) noexcept;

/// The words of a table, and those of the entry in a slot.
using CommanderTable = std::array<Word, kCommanderTableWords>;
[[nodiscard]] inline std::span<const Word, kCommanderWords> entry_words(const CommanderTable& table,
                                                                        std::size_t slot) noexcept {
  return std::span(table).subspan(slot * kCommanderWords).first<kCommanderWords>();
}

}  // namespace splinecast::ipc
