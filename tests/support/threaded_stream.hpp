#pragma once

#include <cstdint>
#include <functional>

#include "support/memory_stream.hpp"

namespace splinecast::testing {

/// How much the threads of a stream do at least.
struct ThreadedOptions {
  std::uint64_t items = 20'000;  ///< that the producer appends
  std::uint64_t reads = 1'000;   ///< that readers, and observers, each succeed in
  int readers = 3;               ///< threads that sample and take snapshots
  int observers = 1;             ///< threads that copy ring items that nobody keeps for them
};

/// What they did. A payload that is not whole counts as torn.
struct ThreadedCounts {
  std::uint64_t appended = 0, replacements = 0, takeovers = 0, revisions = 0;
  std::uint64_t samples = 0, busy = 0, snapshots = 0, observed = 0, overwritten = 0;
  std::uint64_t torn_samples = 0, torn_snapshots = 0, torn_items = 0;
};

/// Runs a producer, a solver that is taken over now and then, readers and passive observers as
/// threads over one span of bytes: ThreadSanitizer takes two mappings of one region for two
/// memories, and sees no race between them. The stream is live, on a clock that the producer moves.
///
/// Payloads validate themselves: a waypoint's position follows from its time and its velocity is
/// the number of its item; dimension 1 has twice the values of dimension 0 and dimension 2 has them
/// with the other sign, which the solve keeps bit for bit. `prepare` sees the stream before the
/// threads.
ThreadedCounts run_threads(const ThreadedOptions& options,
                           const std::function<void(MemoryStream&)>& prepare = {});

}  // namespace splinecast::testing
