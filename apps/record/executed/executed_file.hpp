#pragma once

#include <string>
#include <vector>

#include "apps/record/executed/executed_curve.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// A waypoint that the ring accepted.
struct SentWaypoint {
  ipc::Word item = 0;
  Time time{};
  std::vector<double> position;
  bool is_refused = false;  ///< by the solver
  Time late{};              ///< when the recorder saw it, after its own time; 0 if it was in time
};

/// What a recording has of a stream: of its newest life, if it was created again.
struct ExecutedStream {
  std::string file;          ///< safe to print
  bool ended_early = false;  ///< the file is cut off
  std::size_t lives = 0;     ///< how many times the stream was created, as far as it had a solver
  ExecutedCurve curve;
  std::vector<SentWaypoint> waypoints;  ///< by number
};

/// Reads the executed curve of a stream. Needs the memory of its segments. Throws InputError, with
/// file and message, for a damaged file and for one that has no such stream; the message lists the
/// streams of the file. The curve may be empty.
[[nodiscard]] ExecutedStream read_executed(const std::string& path, const std::string& stream);

/// The names of the streams in a recording that had a solver, without time laws.
[[nodiscard]] std::vector<std::string> executed_streams(const std::string& path);

/// The time law of a stream, if the file has it: that with the id which the stream names, and not
/// empty. Throws as read_executed().
[[nodiscard]] std::optional<ExecutedCurve> read_law(const std::string& path,
                                                    const ExecutedCurve& curve);

/// Says on standard error what is to be known of a stream of a file: that the file is cut off, that
/// the stream was created several times, that segments are missing.
void say_what_is_missing(const ExecutedStream& stream);

}  // namespace splinecast::apps::record
