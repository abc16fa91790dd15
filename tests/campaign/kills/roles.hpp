#pragma once

#include "tests/campaign/kills/plan.hpp"

/// What the processes of an attacked stream run, until SIGTERM asks them to end or SIGKILL ends
/// them. Each throws what it cannot go on after, which ends its process with a code other than 0.
namespace splinecast::campaign {

/// Sends the stream's waypoints, from where the one before it died. A recorded stream is finished
/// behind its last waypoint, a live one when the process is asked to end; a live one replaces its
/// future now and then.
void run_producer(const Plan& plan, Journal& journal);

/// Solves whatever stands under the stream's name.
void run_solver(const Plan& plan, Journal& journal);

/// Reads and checks; attaches again when the stream was removed or made anew.
void run_reader(const Plan& plan, ReaderFacts& facts);

/// Removes the stream, as `rm` does.
void run_remover(const Plan& plan, Journal& journal);

}  // namespace splinecast::campaign
