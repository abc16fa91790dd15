#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/state.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {

/// A time law, commanded by real processes, and a stream that may follow it.
class Rate : public ::testing::Test {
 protected:
  /// `rate LAW` with these arguments, to its end. A request is waited for as long as it takes.
  [[nodiscard]] testing::Ended rate(const std::vector<std::string>& arguments = {}) const {
    return testing::run(command(arguments));
  }
  /// The same as a process that runs on.
  [[nodiscard]] testing::Process start_rate(const std::vector<std::string>& arguments) const {
    return testing::Process(command(arguments));
  }
  /// `rate LAW --json`; null if there is no law.
  [[nodiscard]] nlohmann::json shown() const {
    const testing::Ended ended = rate({"--json"});
    return ended.code == 0 ? nlohmann::json::parse(ended.out) : nlohmann::json();
  }
  /// What a commander requests, as `rate LAW --json` shows it.
  [[nodiscard]] nlohmann::json commander(const std::string& name) const {
    const nlohmann::json all = shown();
    if (all.is_null()) return {};
    for (const nlohmann::json& each : all["commanders"]) {
      if (each["name"] == name) return each;
    }
    return {};
  }

  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"rate", law()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const bool has_wait = std::ranges::find(arguments, "--wait") != arguments.end();
    if (!has_wait) all.insert(all.end(), {"--wait", "600"});
    return all;
  }

  /// The straight line after a ramp is curved by rounding.
  static constexpr double kRounding = 1e-9;

  /// The law's rate now, as published; below 0 before it has begun.
  [[nodiscard]] double law_rate() {
    if (!reader_) reader_.emplace(law(), testing::kPatience);
    State state(1);
    return has_values(reader_->preview(clock_.now(), state)) ? state.velocity()[0] : -1;
  }
  [[nodiscard]] bool await_rate(double wanted) {
    return testing::await([&] { return std::abs(law_rate() - wanted) < kRounding; });
  }

  /// A line through 0 with slope 1, a waypoint every 50 ms.
  [[nodiscard]] std::string line_file(int waypoints) const {
    std::string text = "t,x\n";
    for (int i = 0; i < waypoints; ++i) text += fmt::format("{0},{0}\n", i / 20.0);
    return folder_.write("line.csv", text);
  }

  [[nodiscard]] const std::string& law() const { return law_.name(); }
  [[nodiscard]] const std::string& arm() const { return arm_.name(); }

  testing::TestFolder folder_;
  testing::TestStream law_;
  testing::TestStream arm_;
  MonotonicClock clock_;
  std::optional<Reader> reader_;
};

}  // namespace splinecast::apps
