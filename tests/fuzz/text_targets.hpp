#pragma once

#include <string_view>

/// Targets for hostile text: every file that the program reads, and its arguments. Each target
/// accepts any text. It throws Broken if a promise is broken. Text may be refused with the
/// exceptions that the parsers document.
namespace splinecast::fuzz {

/// A waypoint file, CSV or TUM text, after a first line with options: columns for `--columns`,
/// kinds for `--kind` and a unit for `--time-unit`, separated by spaces.
void try_waypoints(std::string_view text);

/// Messages of a topic, or a ULog. The first line is `ENCODING TYPE` and options: `field=PATH`,
/// `joint=NAME`, `time=PATH`, `log`. The second line is the schema. Each message has its length in
/// two bytes before it.
void try_topics(std::string_view text);

/// A file of times for `--at`, after a first line with a unit for `--time-unit`.
void try_times(std::string_view text);

/// A file of polynomials.
void try_polynomials(std::string_view text);

/// A file of limits: YAML or URDF.
void try_limits(std::string_view text);

/// An MCAP file: read, and recovered.
void try_recordings(std::string_view text);

/// Numbers, times, conditions, kinds and names, one on each line.
void try_words(std::string_view text);

/// A command line, one argument per line. It is parsed, but its action is not run.
void try_arguments(std::string_view text);

}  // namespace splinecast::fuzz
