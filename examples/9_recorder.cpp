// A controller with a tick of 1 ms: samples a stream and writes a CSV file with time, position,
// velocity, acceleration and jerk of each dimension, and the status.
//
//   9_recorder [STREAM [SECONDS [FILE]]]      default: arm 3 recorded.csv
//
// Needs a producer and a solver. Start it before or after them. It begins when the curve has
// values.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <splinecast/clock.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/reader.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr Time kTick = 1ms;

struct Row {
  Time time{};
  SampleStatus status{};
  std::vector<double> values;  ///< [derivative][dimension]
};

/// Samples at each tick. The values are those at the tick, also if this process wakes up late.
void record(Reader& reader, Time begin, std::vector<Row>& rows) {
  State state(reader.dimensions());
  Time tick = begin;
  for (Row& row : rows) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(tick));  // CLOCK_MONOTONIC
    row.time = tick;
    row.status = reader.sample(tick, state);  // wait-free
    row.values.assign(state.values().begin(), state.values().end());
    tick += kTick;
  }
}

bool write(const char* path, const std::vector<Row>& rows, std::size_t dimensions) {
  std::ofstream file(path);
  file.precision(17);
  file << "t_ns";
  for (const char derivative : {'p', 'v', 'a', 'j'}) {
    for (std::size_t d = 0; d < dimensions; ++d) file << ',' << derivative << '[' << d << ']';
  }
  file << ",status\n";
  for (const Row& row : rows) {
    if (!has_values(row.status)) continue;
    file << row.time.count();
    for (const double value : row.values) file << ',' << value;
    file << ',' << to_string(row.status) << '\n';
  }
  return static_cast<bool>(file.flush());
}

void run(const char* stream, double seconds, const char* path) {
  if (!(seconds > 0 && seconds <= 3600)) throw StreamError("SECONDS: above 0, at most 3600");
  Reader reader(stream, 10s);  // waits up to 10 s for the stream
  const MonotonicClock clock;
  State state(reader.dimensions());
  while (!has_values(reader.sample(clock.now(), state))) {
    if (reader.wait(10s) != WaitStatus::advanced) throw StreamError("the curve has no values");
  }
  // The memory of all rows is there before the loop.
  Row row;
  row.values.resize(state.values().size());
  std::vector<Row> rows(static_cast<std::size_t>(seconds * 1e3), row);
  record(reader, clock.now() + kTick, rows);
  if (!write(path, rows, reader.dimensions())) {
    throw StreamError(std::string(path) + " cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? argv[1] : "arm", argc > 2 ? std::atof(argv[2]) : 3,
        argc > 3 ? argv[3] : "recorded.csv");
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
