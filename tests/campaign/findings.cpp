#include "tests/campaign/findings.hpp"

#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

namespace splinecast::campaign {

std::string_view to_string(Role role) noexcept {
  switch (role) {
    case Role::producer:
      return "producer";
    case Role::solver:
      return "solver";
    case Role::reader:
      return "reader";
    case Role::remover:
      return "rm";
  }
  return "";
}

void Findings::add(const Findings& other) {
  for (std::size_t role = 0; role < kRoles; ++role) {
    kills[role] += other.kills[role];
    recovery[role].add(other.recovery[role]);
  }
  constexpr std::array kCounters{
      &Findings::hangs,     &Findings::unusable,  &Findings::clean_ups,   &Findings::lost,
      &Findings::torn,      &Findings::stepped,   &Findings::changed,     &Findings::wrong,
      &Findings::lives,     &Findings::waypoints, &Findings::passed_over, &Findings::refused,
      &Findings::withdrawn, &Findings::samples,   &Findings::busy,        &Findings::segments,
      &Findings::items,     &Findings::restless,  &Findings::ends};
  for (const auto counter : kCounters) this->*counter += other.*counter;
}

void Findings::add(const ReaderFacts& facts) {
  torn += facts.torn;
  stepped += facts.stepped;
  restless += facts.restless;
  ends += facts.ends;
  changed += facts.changed;
  wrong += facts.wrong;
  samples += facts.samples;
  busy += facts.busy;
  segments += facts.segments;
  items += facts.items;
}

std::uint64_t Findings::all_kills() const noexcept {
  return std::reduce(kills.begin(), kills.end());
}

nlohmann::json Findings::found() const {
  return {{"torn reads", torn},
          {"settled samples changed", changed},
          {"joins with a step", stepped},
          {"curves that do not end at rest", restless},
          {"settled segments that differ from their reference", wrong},
          {"waypoints lost", lost},
          {"hangs", hangs},
          {"starts blocked by files of a killed process", unusable},
          {"files that must be removed by hand", clean_ups}};
}

nlohmann::json Findings::work() const {
  return {{"streams finished and compared", lives},
          {"waypoints interpolated", waypoints},
          {"waypoints passed over", passed_over},
          {"items refused with a reason", refused},
          {"waypoints withdrawn by a replacement", withdrawn},
          {"samples", samples},
          {"busy samples", busy},
          {"segments read", segments},
          {"newest segments of unfinished curves checked", ends},
          {"ring items observed", items}};
}

nlohmann::json Findings::killing() const {
  nlohmann::json all = nlohmann::json::object();
  for (std::size_t role = 0; role < kRoles; ++role) {
    const std::string name(to_string(static_cast<Role>(role)));
    all["kills of " + name] = kills[role];
    const nlohmann::json came_back = recovery[role].result();
    if (came_back["kills"] == 0) continue;
    all["time from kill of " + name + " to new data, p50 [ms]"] = came_back["p50_ms"];
    all["time from kill of " + name + " to new data, p99 [ms]"] = came_back["p99_ms"];
  }
  return all;
}

}  // namespace splinecast::campaign
