#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>
#include <utility>

#include "campaign/campaigns.hpp"
#include "support/exit_codes.hpp"
#include "version.hpp"

namespace splinecast::campaign {
namespace {

/// What page.py says of this machine.
nlohmann::json this_machine() {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(
      popen(SPLINECAST_SOURCE "/tests/campaign/page.py --machine", "r"), &pclose);
  std::string text;
  std::array<char, 256> buffer{};
  while (pipe && std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    text += buffer.data();
  }
  if (text.empty()) throw apps::Failure("page.py --machine says nothing");
  return nlohmann::json::parse(text);
}

}  // namespace

std::string campaign_stream(const std::string& what) {
  return "campaign." + std::to_string(getpid()) + "." + what;
}

Result make_result(const CampaignOptions& options, nlohmann::json promises,
                   const std::string& attack, std::uint64_t count, const std::string& unit,
                   const Findings& findings, nlohmann::json measured, double seconds) {
  measured.update(findings.work());
  return {.json = {{"promise", std::move(promises)},
                   {"attack", attack},
                   {"count", count},
                   {"unit", unit},
                   {"found", findings.found()},
                   {"measured", std::move(measured)},
                   {"machine", this_machine()},
                   {"seconds", seconds},
                   {"command", options.command},
                   {"version", apps::kVersion}},
          .is_sound = findings.is_sound()};
}

}  // namespace splinecast::campaign
