#include "bench/harness/csv_recording.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "bench/harness/bench_stream.hpp"

namespace splinecast::bench {

CsvRecording::CsvRecording(std::size_t dimensions)
    : path_(std::filesystem::temp_directory_path() /
            fmt::format("splinecast_bench.{}.csv", getpid())) {
  std::ofstream file(path_);
  file << "t_ns";
  for (std::size_t d = 0; d < dimensions; ++d) file << ",q" << d;
  Feed feed(dimensions);
  for (std::size_t i = 0; i < kRows; ++i) {
    const Waypoint waypoint = feed.next();
    file << '\n' << waypoint.time.count();
    for (const double x : waypoint.position) file << fmt::format(",{}", static_cast<float>(x));
  }
  file << '\n';
}

const CsvRecording& csv_recording() {
  static const CsvRecording seven(7);
  return seven;
}

}  // namespace splinecast::bench
