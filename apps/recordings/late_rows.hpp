#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What to do with the late rows of a recording: rows whose time is not after that of the previous
/// row, and, on a live stream, rows whose time has settled before they can be sent.
enum class LatePolicy : std::uint8_t {
  refuse,  ///< refuse them, with a reason
  pass,    ///< leave out rows that no curve can contain; send the others unchanged
  shift,   ///< move a late row to a later time, and all rows after it by the same amount
};

/// Reads `refuse`, `pass` or `shift`. Returns nothing for any other text.
[[nodiscard]] std::optional<LatePolicy> parse_late_policy(std::string_view text) noexcept;
[[nodiscard]] std::string_view to_string(LatePolicy policy) noexcept;

/// Counts of the late rows of a recording by kind, and of what was done with them.
struct LateRows {
  ipc::Word duplicate = 0;     ///< same time as the previous row
  ipc::Word out_of_order = 0;  ///< before the previous row
  ipc::Word past = 0;          ///< its time settled before it could be sent; live streams only
  ipc::Word left_out = 0;      ///< late rows that were neither sent nor refused
  ipc::Word shifts = 0;        ///< how often the rest of the recording was shifted
  Time shifted{};              ///< total shift
  Time largest{};              ///< largest lateness of a row

  /// Counts a late row by kind.
  void count(ipc::Word LateRows::*kind, Time lateness) noexcept;

  /// Counts a shift of the rest of the recording.
  void shift(Time by) noexcept;

  LateRows& operator+=(const LateRows& other) noexcept;
  friend bool operator==(const LateRows&, const LateRows&) = default;
};

/// The counts as JSON, and as text: `3 late (1 duplicate, 2 past), at most 0.2 s; …`, empty if no
/// row was late.
[[nodiscard]] nlohmann::ordered_json to_json(const LateRows& late, LatePolicy policy);
[[nodiscard]] std::string in_words(const LateRows& late);

}  // namespace splinecast::apps
