#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "apps/process/child.hpp"
#include "apps/streams/remover.hpp"
#include "splinecast/options.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/time.hpp"

namespace splinecast::bench {

/// Number of knots of a board: 1 s of history at 100 Hz, and the knots ahead of the present.
inline constexpr std::size_t kBusyCapacity = 256;

/// Pause between two polls of the busy streams by the solver process.
inline constexpr Time kSweep{1'000'000};

/// Names of many streams, and one process that solves them, as the command `solve` does, as soon as
/// they have producers. Raises this process's limit of open files. The destructor removes the
/// streams; their producers must have ended.
class SolvedStreams {
 public:
  SolvedStreams(std::size_t count, const SolverOptions& options);
  SolvedStreams(const SolvedStreams&) = delete;
  SolvedStreams& operator=(const SolvedStreams&) = delete;
  ~SolvedStreams();

  [[nodiscard]] const std::vector<std::string>& streams() const { return streams_; }
  [[nodiscard]] pid_t solver() const { return solver_.pid(); }

  /// A reader of each stream, in their order. Waits up to `patience` for each.
  [[nodiscard]] std::vector<Reader> attach_readers(Time patience) const;

 private:
  std::vector<std::string> streams_;
  apps::StreamRemover remover_;
  apps::Child solver_;
};

}  // namespace splinecast::bench
