#include "ipc/requests/stoppers.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "ipc/requests/record.hpp"

namespace splinecast::ipc {

std::array<Word, kStopperRecordWords> words_of(const StopRequest& request) noexcept {
  return {request.number, to_word(request.time), request.is_latched ? Word{1} : Word{0}};
}

std::optional<StopRequest> stop_request_of(
    const std::array<Word, kStopperRecordWords>& words) noexcept {
  const StopRequest request{
      .number = words[0], .time = to_time(words[1]), .is_latched = words[2] == 1};
  const bool is_valid = request.number > 0 && request.time >= Time::zero() && words[2] <= 1;
  return is_valid ? std::optional(request) : std::nullopt;
}

void Stoppers::poll(Time now) {
  constexpr Time kPollInterval = std::chrono::milliseconds(20);
  const bool is_early = now < next_poll_ && now >= next_poll_ - kPollInterval;
  if (is_early && !regions_.has_untried()) return;
  next_poll_ = now + kPollInterval;
  if (!states_.empty() || !regions_.unusable().empty()) note_faults();
  const bool had_unread = std::ranges::any_of(states_, [](const auto& s) { return s.id == 0; });
  const bool has_changed = regions_.poll();
  const auto& unusable = regions_.unusable();
  const bool has_unread = std::ranges::any_of(unusable, &RequestRegions::Unusable::is_unread);
  if (!has_changed && !had_unread && !has_unread) return;
  std::vector<StopperState> states;
  for (const RequestRegions::Source& source : regions_.sources()) {
    const auto known = std::ranges::find(states_, source.id, &StopperState::id);
    states.push_back(known != states_.end() ? std::move(*known)
                                            : StopperState{.name = source.name, .id = source.id});
  }
  for (const RequestRegions::Unusable& each : unusable) {
    if (each.is_unread) states.push_back({.name = each.name, .holds = true, .is_damaged = true});
  }
  states_ = std::move(states);
}

/// Sets what a person must know, by the last read().
void Stoppers::note_faults() {
  std::set<std::string> present;
  bool is_held = false;
  for (const StopperState& state : states_) {
    if (!state.holds) continue;
    is_held = true;
    const bool is_guess = state.is_damaged;
    present.insert("stopper '" + state.name + (is_guess ? "' counts as holding" : "' holds") +
                   " the stream: it stops, and takes no waypoints" +
                   (is_guess ? ". There is no whole request in its region" : ""));
  }
  if (was_held_ && !is_held) present.insert("no stopper holds the stream any more");
  was_held_ = was_held_ || is_held;
  for (const RequestRegions::Unusable& each : regions_.reported()) {
    if (!each.is_unread) {
      present.insert("stopper '" + each.name + "' is not heard: " + each.why);
    }
  }
  faults_.set(std::move(present));
}

std::span<const StopperState> Stoppers::read() noexcept {
  const auto sources = regions_.sources();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    std::array<Word, kStopperRecordWords> words{};
    const RecordCopy copy = copy_record(sources[i].control, words);
    sources[i].seen = copy.sequence;
    if (copy.is_unwritten()) continue;
    const auto request = copy.is_whole ? stop_request_of(words) : std::nullopt;
    StopperState& state = states_[i];
    state.is_damaged = !request;
    state.holds = !request || request->is_latched;
    if (request) state.number = request->number;
  }
  return states_;
}

}  // namespace splinecast::ipc
