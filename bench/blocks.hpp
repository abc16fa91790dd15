#pragma once

#include <string>

namespace splinecast::bench {

/// Runs what is compared with each other in alternation, `blocks` times over: of every group of
/// benchmarks each one once, then each one again. So whatever else the machine does meanwhile meets
/// all of a group alike, and a ratio is taken within a block. Writes the machine and all runs to
/// `out` as JSON. Throws std::runtime_error if `out` cannot be written.
void run_blocks(int blocks, const std::string& out);

}  // namespace splinecast::bench
