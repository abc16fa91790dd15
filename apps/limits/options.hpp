#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "core/limits/named.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::apps {

/// Limits as they are asked for: by options, and by a file.
struct LimitOptions {
  MotionLimits given{};  ///< lists of one value per dimension or one for all
  std::string file;      ///< of named limits; none if empty

  [[nodiscard]] bool any() const noexcept { return given != MotionLimits{} || !file.empty(); }
};

/// `--max-velocity`, `--max-acceleration`, `--max-jerk`, `--bounds`, `--limits`. `scope` says in
/// the help of the first three what keeps them.
void add_limit_options(Command& verb, LimitOptions& options, const std::string& scope = "");

/// `--beyond`.
void add_beyond(Command& verb, std::optional<Beyond>& beyond);

/// What a person should know of how limits met the dimensions of a curve.
struct LimitGaps {
  std::vector<std::string> unmatched;  ///< joints of the file that are the name of no dimension
  std::vector<std::string> without;    ///< dimensions that have no limit
};
[[nodiscard]] LimitGaps limit_gaps(const MotionLimits& limits, std::span<const NamedLimits> joints,
                                   std::span<const std::string> names,
                                   std::span<const Dimension> kinds);

/// The same in words, a line each; none if there is nothing to say.
[[nodiscard]] std::vector<std::string> to_lines(const LimitGaps& gaps);

}  // namespace splinecast::apps
