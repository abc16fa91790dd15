#include "tests/campaign/record/tally.hpp"

#include <fmt/format.h>

#include "apps/process/messages.hpp"

namespace splinecast::campaign::record {

Tally::Tally() {
  for (const char* const kind :
       {"items neither recorded nor lost", "items both recorded and lost",
        "segments neither recorded nor lost", "segments both recorded and lost",
        "numbers twice in a file", "waypoints with other values", "streams not recorded",
        "counts that differ from the sender's", "accounts that differ from the files",
        "reports that differ from the files", "wrong exit codes", "files that cannot be read",
        "files that do not verify", "verifications that do not say what is lost",
        "recovered files that differ", "runs that failed"}) {
    found_[kind] = 0;
  }
}

void Tally::find(const std::string& kind, std::uint64_t seed, const std::string& why,
                 std::uint64_t count) {
  if (count == 0) return;
  auto& counter = found_.at(kind);
  counter = counter.get<std::uint64_t>() + count;
  apps::say(fmt::format("seed {}: {}: {}: {}", seed, kind, count, why));
}

void Tally::count(const std::string& what, std::uint64_t count) { work_[what] = of(what) + count; }

std::uint64_t Tally::of(const std::string& what) const {
  return work_.value(what, std::uint64_t{0});
}

void Tally::add(const nlohmann::json& other) {
  for (const auto& [kind, counter] : other["found"].items()) {
    found_[kind] = found_[kind].get<std::uint64_t>() + counter.get<std::uint64_t>();
  }
  for (const auto& [what, counter] : other["work"].items()) {
    count(what, counter.get<std::uint64_t>());
  }
}

}  // namespace splinecast::campaign::record
