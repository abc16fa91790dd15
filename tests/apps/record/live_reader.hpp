#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "splinecast/reader.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::testing {

/// What a controller got at one time.
struct LiveRow {
  Time time{};
  SampleStatus status{};
  std::vector<double> values;  ///< p, v, a, j of each dimension
};

/// A controller that samples a stream at the present, 1,000 times per second, in a thread of its
/// own.
class LiveReader {
 public:
  /// Waits until the stream has a solver.
  explicit LiveReader(const std::string& stream);
  LiveReader(const LiveReader&) = delete;
  LiveReader& operator=(const LiveReader&) = delete;
  ~LiveReader() { (void)stop(); }

  /// Ends the thread. What it got, except samples that could still change.
  [[nodiscard]] std::vector<LiveRow> stop();

 private:
  Reader reader_;
  std::vector<LiveRow> rows_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

/// Expects that `sample FILE STREAM` gives the same bits and statuses at these times. Returns on
/// how many rows with values.
std::size_t expect_sampled_alike(const std::string& file, const std::string& stream,
                                 const std::vector<LiveRow>& rows);

}  // namespace splinecast::testing
