#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "support/process.hpp"

namespace splinecast::testing {

/// Whether there is a browser to try pages in (Debian: chromium).
bool has_browser();

/// The text between two marks, from the first one on.
std::string between(const std::string& text, const std::string& begin, const std::string& end);

/// The data that a page draws, out of its file.
nlohmann::json data_of(const std::string& page);

/// What a script of tests/apps/ notes of a page in a browser that opens it with this hash; null,
/// and a failed test, if it notes nothing.
nlohmann::json facts_of(const TestFolder& folder, const std::string& page,
                        const std::string& script, const std::string& hash);

}  // namespace splinecast::testing

/// Skips the test by name on a machine without a browser.
#define REQUIRE_BROWSER() \
  if (!::splinecast::testing::has_browser()) GTEST_SKIP() << "no chromium (Debian: chromium)"
