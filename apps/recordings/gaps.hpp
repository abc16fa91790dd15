#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "apps/cli/command.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What to do about a gap: a pause of the source.
enum class GapPolicy : std::uint8_t {
  split,   ///< the motion stops, and starts again for the next row
  bridge,  ///< one segment, as between any other two rows
  refuse,  ///< refuse the recording
};

[[nodiscard]] std::string_view to_string(GapPolicy policy) noexcept;

/// Options about gaps.
struct GapOptions {
  GapPolicy policy = GapPolicy::split;
  std::optional<Time> longer_than{};  ///< unset: see gap_length()

  friend bool operator==(const GapOptions&, const GapOptions&) = default;
};

/// Reads `S`, `POLICY` or `S:POLICY`: a number of seconds above 0, and `split`, `bridge` or
/// `refuse`. Returns nothing for any other text.
[[nodiscard]] std::optional<GapOptions> parse_gap(std::string_view text);

/// The length from which an interval is a gap: what the options say, else ten median intervals, at
/// least 0.5 s.
[[nodiscard]] Time gap_length(const GapOptions& options, Time median) noexcept;

/// Adds `--gap`.
void add_gap(Command& verb, GapOptions& gap);

/// The message about a gap that is refused, between two places of a file.
[[nodiscard]] std::string gap_refusal(const std::string& place, Time length,
                                      const std::string& before);

/// The gaps of a recording.
struct Gaps {
  /// A gap, and the rows before and after it.
  struct Gap {
    Time length{};
    std::size_t after = 0;   ///< number of the row before the gap: see Row::number
    std::size_t before = 0;  ///< number of the row after it
  };
  static constexpr std::size_t kListed = 10;

  std::size_t count = 0;
  std::size_t listed = 0;
  std::array<Gap, kListed> largest{};  ///< the first `listed` ones are set, the longest first

  void add(const Gap& gap) noexcept;
};

/// The gaps as JSON, and as text: `2 gaps split, the longest 12 s from line 3 to line 4`, empty if
/// there is none. `row_name`: see RowReader::row_name().
[[nodiscard]] nlohmann::ordered_json to_json(const Gaps& gaps, GapPolicy policy);
[[nodiscard]] std::string in_words(const Gaps& gaps, GapPolicy policy, std::string_view row_name);

}  // namespace splinecast::apps
