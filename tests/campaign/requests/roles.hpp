#pragma once

#include <cstdint>
#include <string>

#include "tests/campaign/requests/facts.hpp"

/// The processes of the campaign of requests. Each runs until SIGTERM or SIGKILL.
namespace splinecast::campaign {

/// Solves a law or a stream.
void run_solver_of(const std::string& stream);

/// A commander that makes random requests, and checks that each is in force and has its effect.
void run_commander(const std::string& law, const std::string& name, std::uint64_t seed,
                   RequestFacts& facts);

/// Samples the law, and compares its rate with the bounds of its commanders.
void run_bound_check(const std::string& law, RequestFacts& facts);

/// Uses a CPU.
void run_busy();

}  // namespace splinecast::campaign
