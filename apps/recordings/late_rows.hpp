#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What becomes of the late rows of a recording: of those whose time is not after that of the row
/// before, and of those whose time has settled when they can be sent to a live stream.
enum class LatePolicy : std::uint8_t {
  refuse,  ///< they are refused, with a reason
  pass,    ///< rows that no curve can contain are left out; the others are sent as they are
  shift,   ///< a late row is moved, and all rows behind it by as much
};

/// Reads `refuse`, `pass` or `shift`. Returns nothing for any other text.
[[nodiscard]] std::optional<LatePolicy> parse_late_policy(std::string_view text) noexcept;
[[nodiscard]] std::string_view to_string(LatePolicy policy) noexcept;

/// The late rows of a recording by kind, and what became of them.
struct LateRows {
  ipc::Word duplicate = 0;     ///< the time of the row before
  ipc::Word out_of_order = 0;  ///< earlier than the row before
  ipc::Word past = 0;          ///< settled when it could be sent; live streams only
  ipc::Word left_out = 0;      ///< of all these, rows that were neither sent nor refused
  ipc::Word shifts = 0;        ///< how often the rest of the recording was moved
  Time shifted{};              ///< by how much in all
  Time largest{};              ///< largest lateness of a row

  /// Counts a row of a kind that is late by so much.
  void count(ipc::Word LateRows::*kind, Time lateness) noexcept;

  /// Moves the rest of the recording once more.
  void shift(Time by) noexcept;

  LateRows& operator+=(const LateRows& other) noexcept;
  friend bool operator==(const LateRows&, const LateRows&) = default;
};

/// As JSON, and in words: `3 late (1 duplicate, 2 past), at most 0.2 s; …`; empty if no row was
/// late.
[[nodiscard]] nlohmann::ordered_json to_json(const LateRows& late, LatePolicy policy);
[[nodiscard]] std::string in_words(const LateRows& late);

}  // namespace splinecast::apps
