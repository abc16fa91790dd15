#pragma once

#include <span>

#include "apps/cli/command.hpp"
#include "apps/fit/curve.hpp"

namespace splinecast::apps {

/// Adds the options of a curve that is fitted to a file: `--lambda`, `--time-scale`, `--start`,
/// `--end`, `--online`, `--settle`, `--tail`, `--force-lag`, `--gap`.
void add_curve(Command& verb, CurveOptions& options, const std::string& end_help);

/// Throws UsageError for options that exclude one another or that the methods do not support.
void require_consistent(const CurveOptions& curve, std::span<const Method* const> methods);

}  // namespace splinecast::apps
