#pragma once

#include <cstdint>
#include <string>

#include "tests/campaign/requests/facts.hpp"

/// The processes around a stream that stoppers hold. Each runs until SIGTERM or SIGKILL.
namespace splinecast::campaign {

/// Sends a motion whenever no stopper holds the stream. Sometimes finishes the stream and creates
/// it again.
void run_stopped_producer(const std::string& stream, std::uint64_t seed, RequestFacts& facts);

/// A stopper that holds the stream at random, and checks that each stop is in force and that the
/// machine rests until the release. Continues what a killed stopper of its name has left.
void run_stopper(const std::string& stream, const std::string& name, std::uint64_t seed,
                 RequestFacts& facts);

}  // namespace splinecast::campaign
