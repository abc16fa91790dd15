#include "tests/apps/record/recorded.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <utility>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"

namespace splinecast::testing {
namespace {

ProducerOptions recorded_options(std::size_t capacity) {
  return {.dimensions = 2,
          .names = {"x", "a \"b\""},
          .clock = StreamClock::recorded,
          .capacity = capacity};
}

std::vector<double> on_a_circle(std::size_t i) {
  const double s = 0.1 * static_cast<double>(i);
  return {std::sin(s), std::cos(s) * 1.1};
}

}  // namespace

SteppedStream::SteppedStream(const std::string& name, SolverOptions options, std::size_t capacity)
    : producer(name, recorded_options(capacity)), solver(name, options) {
  EXPECT_TRUE(solver.attach(clock_));
}

void SteppedStream::step() {
  while (solver.step(clock_).consumed > 0) {
  }
}

void SteppedStream::append_until(std::size_t count, const Positions& at) {
  for (; count_ < count; ++count_) {
    const std::vector<double> x = at ? at(count_) : on_a_circle(count_);
    const Time time = std::chrono::milliseconds(10) * static_cast<std::int64_t>(count_);
    ASSERT_EQ(producer.append({.time = time, .position = x}), AppendStatus::accepted);
    step();
  }
}

void SteppedStream::finish() {
  ASSERT_EQ(producer.finish({.kind = ConditionKind::halt, .value = {}}), AppendStatus::accepted);
  step();
}

Process start_recorder(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "record");
  Process recorder(arguments);
  recorder.await_message("recording to");
  return recorder;
}

bool await_file(const std::string& path, std::uintmax_t size) {
  return await([&] {
    std::error_code error;
    const auto found = std::filesystem::file_size(path, error);
    return !error && found >= size;
  });
}

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

Verified verify(const std::string& path) {
  const Ended ended = run({"replay", "--verify", "--json", path});
  Verified found{.code = ended.code, .err = ended.err, .json = {}};
  if (ended.code == 0 || ended.code == 3 || ended.code == 5)
    found.json = nlohmann::json::parse(ended.out);
  return found;
}

std::vector<nlohmann::json> messages_of(const std::string& path, const std::string& topic) {
  const apps::TextFile file(path);
  apps::mcap::Reader reader(path, std::as_bytes(std::span(file.text())));
  std::vector<nlohmann::json> found;
  apps::mcap::Message message;
  while (reader.next(message)) {
    if (message.channel->topic != topic) continue;
    const auto* const text = reinterpret_cast<const char*>(message.data.data());  // NOLINT
    found.push_back(nlohmann::json::parse(text, text + message.data.size()));
  }
  return found;
}

void expect_verified(const std::string& path, const std::string& stream) {
  const Verified found = verify(path);
  EXPECT_EQ(found.code, 0) << path << ": " << found.err << found.json.dump(1);
  const nlohmann::json at = found.stream(stream);
  ASSERT_FALSE(at.is_null()) << path << " does not have " << stream;
  EXPECT_GT(at["equal"], 0) << path;
  EXPECT_EQ(at["unverified"], 0) << path;
}

}  // namespace splinecast::testing
