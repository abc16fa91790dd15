#pragma once

#include <string>
#include <vector>

#include "splinecast/core/time.hpp"

namespace splinecast::bench {

/// Waypoints of a smooth motion at 100 Hz with jitter: what every benchmark is fed.
struct Waypoints {
  std::size_t dimensions;
  std::vector<core::Time> times;
  std::vector<double> positions;  ///< [waypoint][dimension]

  Waypoints(std::size_t count, std::size_t dims);
};

/// A finished recorded stream in shared memory, removed at the end.
class BenchStream {
 public:
  explicit BenchStream(const Waypoints& waypoints);
  BenchStream(const BenchStream&) = delete;
  BenchStream& operator=(const BenchStream&) = delete;
  ~BenchStream();
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

}  // namespace splinecast::bench
