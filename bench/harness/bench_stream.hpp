#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::bench {

/// Adds one row for each number of dimensions.
void all_dimensions(benchmark::internal::Benchmark* bench);

/// Waypoints of a smooth motion at 100 Hz with jitter: the input of every benchmark.
struct Waypoints {
  std::size_t dimensions;
  std::vector<Time> times;
  std::vector<double> positions;  ///< [waypoint][dimension]

  Waypoints(std::size_t count, std::size_t dims);
  [[nodiscard]] std::span<const double> position(std::size_t i) const {
    return std::span(positions).subspan(i * dimensions, dimensions);
  }
};

/// An endless sequence of waypoints: repeats the same positions at times that continue.
class Feed {
 public:
  explicit Feed(std::size_t dimensions);
  Waypoint next();

 private:
  Waypoints waypoints_;
  std::size_t i_ = 0;
  Time offset_{};
};

/// A unique stream name of this process. The destructor removes the stream of that name.
class StreamName {
 public:
  StreamName();
  StreamName(const StreamName&) = delete;
  StreamName& operator=(const StreamName&) = delete;
  ~StreamName();
  operator const std::string&() const { return name_; }  // NOLINT(*-explicit-*)

 private:
  std::string name_;
};

/// A finished recorded stream in shared memory.
class BenchStream {
 public:
  explicit BenchStream(const Waypoints& waypoints);
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  StreamName name_;
};

}  // namespace splinecast::bench
