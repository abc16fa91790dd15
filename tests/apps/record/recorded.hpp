#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Streams to record, and recordings as tests read them.
namespace splinecast::testing {

/// Skips the test in a build without MCAP.
class RecorderTest : public ::testing::Test {
 protected:
  void SetUp() override { REQUIRE_MCAP(); }
};

/// A stream of two dimensions with recorded times, produced and solved in this process: nothing
/// happens unless the test calls it.
class SteppedStream {
 public:
  /// `capacity`: of the ring.
  explicit SteppedStream(const std::string& name, SolverOptions solver = {},
                         std::size_t capacity = 1024);

  /// Appends waypoints until there are `count`, and solves them. `at` gives the positions.
  using Positions = std::function<std::vector<double>(std::size_t)>;
  void append_until(std::size_t count, const Positions& at = {});
  void finish();

  Producer producer;
  Solver solver;

 private:
  void step();
  MonotonicClock clock_;
  std::size_t count_ = 0;
};

/// Starts `record` with these arguments and waits until it has opened its file.
[[nodiscard]] Process start_recorder(std::vector<std::string> arguments);

/// Whether a recorder has read what a stream has: waits until its file is `size` bytes or more.
[[nodiscard]] bool await_file(const std::string& path, std::uintmax_t size = 1);

/// The paths of the files *.mcap in a folder, sorted.
[[nodiscard]] std::vector<std::string> recordings_in(const std::string& folder);

/// `replay --verify --json` of a recording.
struct Verified {
  int code = 0;
  std::string err;
  nlohmann::json json;  ///< null unless the code is 0, 3 or 5

  [[nodiscard]] nlohmann::json stream(const std::string& name) const {
    return json.is_object() ? json["streams"].value(name, nlohmann::json()) : nlohmann::json();
  }
};
[[nodiscard]] Verified verify(const std::string& path);

/// The messages of a topic, as JSON.
[[nodiscard]] std::vector<nlohmann::json> messages_of(const std::string& path,
                                                      const std::string& topic);

/// Expects that every segment of a stream in a recording is there and verified.
void expect_verified(const std::string& path, const std::string& stream);

}  // namespace splinecast::testing
