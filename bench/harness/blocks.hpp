#pragma once

#include <string>

namespace splinecast::bench {

/// Runs each group of benchmarks in `blocks` blocks: in a block, each benchmark of the group runs
/// once. Other load on the machine affects all benchmarks of a group in the same way, and a ratio
/// is taken within a block of a group. Slow groups have fewer blocks. Writes the machine and all
/// runs, each with its group and block, to `out` as JSON. Throws std::runtime_error if `out` cannot
/// be written.
void run_blocks(int blocks, const std::string& out);

}  // namespace splinecast::bench
