#pragma once

#include <optional>
#include <string>

#include "splinecast/solver.hpp"
#include "tests/campaign/kills/plan.hpp"

/// Main functions of the processes of an attacked stream. They run until SIGTERM or SIGKILL. A
/// fatal error is thrown and ends the process with a code other than 0.
namespace splinecast::campaign {

/// Sends the stream's waypoints and continues where a killed producer stopped. Finishes a recorded
/// stream after its last waypoint, and a live one on SIGTERM. Replaces the future of a live stream
/// at random instants.
void run_producer(const Plan& plan, Journal& journal);

/// A solver of a stream, when the locks of a killed one are free; nothing after SIGTERM.
[[nodiscard]] std::optional<Solver> await_solver(const std::string& stream,
                                                 const SolverOptions& options);

/// Solves the stream of this name.
void run_solver(const Plan& plan, Journal& journal);

/// Reads and checks the stream; attaches again when it was removed or recreated.
void run_reader(const Plan& plan, ReaderFacts& facts);

/// Removes the stream like `rm`.
void run_remover(const Plan& plan, Journal& journal);

}  // namespace splinecast::campaign
