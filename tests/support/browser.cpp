#include "support/browser.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace splinecast::testing {
namespace {

constexpr const char* kChromium = "/usr/bin/chromium";

}  // namespace

bool has_browser() { return access(kChromium, X_OK) == 0; }

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return {};
  const std::size_t first = from + begin.size();
  return text.substr(first, text.find(end, first) - first);
}

nlohmann::json data_of(const std::string& page) {
  return nlohmann::json::parse(between(page, "id=\"data\">", "</script>"));
}

nlohmann::json facts_of(const TestFolder& folder, const std::string& page,
                        const std::string& script, const std::string& hash) {
  const std::string source = read_file(std::string(SPLINECAST_SOURCE) + "/tests/apps/" + script);
  const auto file = folder.write("facts.html", page + "<script>" + source + "</script>");
  const Ended ended =
      Process(kChromium, {"--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                          "--window-size=1280,1600", "--user-data-dir=" + folder.path("profile"),
                          "--timeout=60000", "--dump-dom", "file://" + file + "#" + hash})
          .wait();
  const std::string facts = between(ended.out, "<pre>FACTS", "FACTS</pre>");
  EXPECT_FALSE(facts.empty()) << ended.err;
  return facts.empty() ? nlohmann::json() : nlohmann::json::parse(facts);
}

}  // namespace splinecast::testing
