#include "ipc/law/commander_faults.hpp"

#include "core/basics/number_text.hpp"

namespace splinecast::ipc {

std::set<std::string> faults_of(const Commanders& commanders, const CommandedRate& rate,
                                double largest) {
  std::set<std::string> present;
  const auto note = [&](bool is_so, const CommanderState& state, const std::string& text) {
    if (is_so) present.insert("commander '" + state.name + "' " + text);
  };
  for (const RequestRegions::Unusable& unusable : commanders.regions().reported()) {
    present.insert("commander '" + unusable.name + "' is not heard: " + unusable.why);
  }
  for (const CommanderState& state : commanders.states()) {
    const bool is_known = rate.knows(state.id);
    note(state.is_used() && !is_known, state,
         "is not heard: the law has " + std::to_string(kMostCommanders) + " others");
    note(is_known && state.is_damaged, state,
         "counts as requesting rate 0: its region holds no whole request");
    note(is_known && state.is_dead, state,
         "counts as requesting rate 0 until its next request: its dead man has fired");
    note(is_known && state.command.rate > largest, state,
         "requests rate " + core::number_text(state.command.rate) +
             ", which counts as the largest, " + core::number_text(largest));
  }
  return present;
}

}  // namespace splinecast::ipc
