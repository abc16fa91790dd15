#include "tests/apps/record/live_reader.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string_view>

#include "splinecast/clock.hpp"
#include "tests/fixtures/processes/patience.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {

LiveReader::LiveReader(const std::string& stream)
    : reader_(stream, kPatience), thread_([this] {
        const MonotonicClock clock;
        State state(reader_.dimensions());
        while (!ends_) {
          const Time now = clock.now();
          const SampleStatus status = reader_.sample(now, state);
          const bool may_change =
              status == SampleStatus::provisional || status == SampleStatus::revised;
          if (has_values(status) && !may_change) {
            rows_.push_back({now, status, {state.values().begin(), state.values().end()}});
          }
          std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a rate, not a wait
        }
      }) {}

std::vector<LiveRow> LiveReader::stop() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  return std::move(rows_);
}

std::size_t expect_sampled_alike(const std::string& file, const std::string& stream,
                                 const std::vector<LiveRow>& rows) {
  const TestFolder folder;
  std::string times = "t_ns\n";
  for (const LiveRow& row : rows) times += fmt::format("{}\n", row.time.count());
  const Ended ended = run({"sample", file, stream, "--at", folder.write("times.csv", times)});
  EXPECT_EQ(ended.code, 0) << ended.err;
  std::string_view text = ended.out;
  const auto next_line = [&] {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    return line;
  };
  (void)next_line();
  std::size_t alike = 0;
  for (const LiveRow& row : rows) {
    std::string wanted = fmt::format("{}", row.time.count());
    for (const double value : row.values) wanted += fmt::format(",{}", value);
    wanted += fmt::format(",{},", to_string(row.status));
    const std::string_view line = next_line();
    EXPECT_EQ(line.substr(0, line.rfind(',') + 1), wanted);
    if (line.starts_with(wanted)) ++alike;
    if (::testing::Test::HasFailure()) break;
  }
  return alike;
}

}  // namespace splinecast::testing
