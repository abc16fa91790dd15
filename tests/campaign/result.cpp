#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <memory>
#include <utility>

#include "apps/cli/version.hpp"
#include "apps/process/exit_codes.hpp"
#include "tests/campaign/campaigns.hpp"

namespace splinecast::campaign {
namespace {

/// Standard output of a command.
std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string text;
  std::array<char, 256> buffer{};
  while (pipe && std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    text += buffer.data();
  }
  return text;
}

}  // namespace

nlohmann::json this_machine() {
  const std::string text = output_of(SPLINECAST_SOURCE "/tests/campaign/page.py --machine");
  if (text.empty()) throw apps::Failure("page.py --machine prints nothing");
  return nlohmann::json::parse(text);
}

std::string this_build() {
  std::string commit =
      output_of("git -C " SPLINECAST_SOURCE " describe --always --dirty --abbrev=12 2>/dev/null");
  while (!commit.empty() && commit.back() == '\n') commit.pop_back();
  if (commit.empty()) commit = "unknown commit";
  return commit + ", " SPLINECAST_BUILD;
}

std::string today() {
  std::string date = output_of("date --utc +%Y-%m-%d");
  while (!date.empty() && date.back() == '\n') date.pop_back();
  return date;
}

double cpu_seconds() noexcept { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::string campaign_stream(const std::string& what) {
  return "test." + std::to_string(getpid()) + "." + what;
}

Result make_result(const CampaignOptions& options, nlohmann::json promises,
                   const std::string& attack, std::uint64_t count, const std::string& unit,
                   nlohmann::json found, nlohmann::json measured, double seconds) {
  const bool is_sound =
      std::ranges::all_of(found, [](const auto& violations) { return violations == 0; });
  return {.json = {{"promise", std::move(promises)},
                   {"attack", attack},
                   {"count", count},
                   {"unit", unit},
                   {"found", std::move(found)},
                   {"measured", std::move(measured)},
                   {"machine", this_machine()},
                   {"seconds", seconds},
                   {"date", today()},
                   {"command", options.command},
                   {"version", apps::kVersion},
                   {"build", this_build()}},
          .is_sound = is_sound};
}

Result make_result(const CampaignOptions& options, nlohmann::json promises,
                   const std::string& attack, std::uint64_t count, const std::string& unit,
                   const Findings& findings, nlohmann::json measured, double seconds) {
  measured.update(findings.work());
  return make_result(options, std::move(promises), attack, count, unit,
                     nlohmann::json(findings.found()), std::move(measured), seconds);
}

}  // namespace splinecast::campaign
