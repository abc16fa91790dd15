#pragma once

#include <CLI/CLI.hpp>
#include <span>

#include "apps/fit/curve.hpp"

namespace splinecast::apps {

/// What shapes a curve that is fitted to a file: `--lambda`, `--time-scale`, `--start`, `--end`,
/// `--online`, `--settle`, `--tail`, `--force-lag`.
void add_curve(CLI::App& verb, CurveOptions& options);

/// Throws CLI::ValidationError for options that do not go with one another or with the methods.
void require_consistent(const CurveOptions& curve, std::span<const Method* const> methods);

}  // namespace splinecast::apps
