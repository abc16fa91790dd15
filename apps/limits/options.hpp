#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "core/limits/named.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::apps {

/// The requested limits: from options, and from a file.
struct LimitOptions {
  MotionLimits given{};  ///< lists of one value per dimension or one for all
  std::string file;      ///< of named limits; empty: no file

  [[nodiscard]] bool any() const noexcept { return given != MotionLimits{} || !file.empty(); }
};

/// Adds `--max-velocity`, `--max-acceleration`, `--max-jerk`, `--bounds` and `--limits`. `scope`
/// ends the help of the first three: to which parts of the curve they apply.
void add_limit_options(Command& verb, LimitOptions& options, const std::string& scope = "");

/// Limits without a dimension, and dimensions of a curve without a limit.
struct LimitGaps {
  std::vector<std::string> unmatched;  ///< joints of the file that match no dimension
  std::vector<std::string> without;    ///< dimensions that have no limit
};
[[nodiscard]] LimitGaps limit_gaps(const MotionLimits& limits, std::span<const NamedLimits> joints,
                                   std::span<const std::string> names,
                                   std::span<const Dimension> kinds);

/// The gaps as messages, at most one line of each kind.
[[nodiscard]] std::vector<std::string> to_lines(const LimitGaps& gaps);

}  // namespace splinecast::apps
