#pragma once

#include <string>

namespace splinecast::bench {

/// Runs what is compared with each other in alternation, `blocks` times over: of every group of
/// benchmarks each one once, then each one again. Whatever else the machine does meanwhile affects
/// all of a group alike, and a ratio is taken within a block of a group. Groups that take long have
/// fewer blocks. Writes the machine and all runs, each with its group and block, to `out` as JSON.
/// Throws std::runtime_error if `out` cannot be written.
void run_blocks(int blocks, const std::string& out);

}  // namespace splinecast::bench
