#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {

/// Rows that cannot be interpolated: each one is listed with its line, and the counts of all rows
/// add up, whether the file, the append or the solver refused them.
class Ingest : public ::testing::Test {
 protected:
  [[nodiscard]] const std::string& name() const { return stream_.name(); }
  [[nodiscard]] testing::Ended replay(const std::string& file,
                                      const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"replay",  file,       "--stream", name(),
                                       "--clock", "recorded", "--rate",   "max"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return testing::run(arguments);
  }
  /// Expects that a report accounts for `planned` rows and lists each one that is not interpolated.
  static void expect_accounted_for(const testing::Ended& ended, std::size_t planned) {
    const auto report = nlohmann::json::parse(ended.out);
    const auto number = [&](const char* key) { return report[key].get<std::size_t>(); };
    EXPECT_EQ(number("sent") + number("skipped") + number("unsent"), planned);
    EXPECT_EQ(number("interpolated") + number("passed_over") + number("refused"), number("sent"));
    EXPECT_EQ(report["rows"].size() + number("rows_not_listed"),
              number("skipped") + number("refused"));
    for (const auto& row : report["rows"]) {
      const std::string line = fmt::format(":{}:", row["line"].get<std::size_t>());
      EXPECT_NE(ended.err.find(line), std::string::npos) << line;
    }
  }
  static std::size_t count(const nlohmann::json& report, const std::string& by) {
    return static_cast<std::size_t>(std::ranges::count_if(
        report["rows"], [&](const nlohmann::json& row) { return row["by"] == by; }));
  }

  testing::TestStream stream_;
};

}  // namespace splinecast::apps
