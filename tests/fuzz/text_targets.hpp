#pragma once

#include <string_view>

/// What is done with hostile text: every file that the program reads and every argument that it is
/// given. Each target takes any text and returns; it throws Broken if a promise is broken. Text may
/// be refused by the exceptions that the parsers document.
namespace splinecast::fuzz {

/// A waypoint file, CSV or TUM text. Its first line is taken off: columns for `--columns`, kinds
/// for
/// `--kind` and a unit for `--time-unit`, with spaces between.
void try_waypoints(std::string_view text);

/// A file of times for `--at`, its first line a unit as above.
void try_times(std::string_view text);

/// A file of polynomials.
void try_polynomials(std::string_view text);

/// A file of limits: YAML, or a URDF.
void try_limits(std::string_view text);

/// Numbers, times, conditions, kinds and names, one on each line.
void try_words(std::string_view text);

/// A command line, one argument on each line: parsed, its action not run.
void try_arguments(std::string_view text);

}  // namespace splinecast::fuzz
