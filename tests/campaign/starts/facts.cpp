#include "tests/campaign/starts/facts.hpp"

#include <fmt/format.h>

#include "apps/process/messages.hpp"

namespace splinecast::campaign::starts {
namespace {

constexpr std::array<std::string_view, kBreaches> kNamesOfBreaches{
    "steps of the controller",
    "samples beyond a limit without a counted excess",
    "executed samples that were changed",
    "times of another clock that were accepted",
    "accepted replacements that were refused as too late",
    "items without an account",
    "producers that could not begin",
    "items that no solver has taken",
    "items with a wrong outcome, or none"};

constexpr std::array<std::string_view, kEvents> kNamesOfEvents{
    "beginnings",
    "streams created again",
    "streams created after rm",
    "rings continued in motion",
    "rings continued at rest",
    "motions replaced by a first waypoint",
    "times of another clock refused",
    "first waypoints refused as elsewhere",
    "first waypoints refused as past",
    "replacements refused as too late by the producer",
    "starts from the old end",
    "starts from a measured state",
    "starts of a machine that was moved",
    "starts by a replacement",
    "starts by a replacement as soon as possible",
    "replacements that were late for the solver",
    "streams finished without a waypoint",
    "streams sent at once",
    "producers killed",
    "streams finished",
    "solvers restarted",
    "pauses of a solver",
    "excesses counted",
    "samples compared",
    "boards that the controller has left",
    "outcomes of items compared",
    "items in force by an entry",
    "items passed over",
    "items withdrawn",
    "items refused by the solver",
    "items forgotten"};

}  // namespace

std::string_view to_string(Breach breach) noexcept {
  return kNamesOfBreaches[static_cast<std::size_t>(breach)];
}

std::string_view to_string(Event event) noexcept {
  return kNamesOfEvents[static_cast<std::size_t>(event)];
}

void Facts::breach(Breach breach, std::uint64_t seed, const std::string& what) {
  constexpr std::uint64_t kReported = 20;
  if (++breaches[static_cast<std::size_t>(breach)] > kReported) return;
  apps::say(fmt::format("seed {}: {}: {}", seed, to_string(breach), what));
}

}  // namespace splinecast::campaign::starts
