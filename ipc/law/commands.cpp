#include "ipc/law/commands.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <thread>
#include <utility>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/requests/record.hpp"

namespace splinecast::ipc {
namespace {

/// When a command expires; max() if it does not.
Time expiry_of(const RateCommand& command) noexcept {
  const bool expires = command.rate > 0 && command.dead_man > Time::zero();
  return expires ? saturated_sum(command.time, command.dead_man) : Time::max();
}

}  // namespace

/// Gives each region its state: a new one nothing is known of yet.
void Commanders::match_states() {
  std::vector<CommanderState> states;
  for (const RequestRegions::Source& source : regions_.sources()) {
    const auto known = std::ranges::find(states_, source.id, &CommanderState::id);
    states.push_back(known != states_.end() ? std::move(*known)
                                            : CommanderState{.name = source.name, .id = source.id});
  }
  states_ = std::move(states);
}

void Commanders::poll(bool needs_room) {
  if (regions_.poll()) match_states();
  check_processes(needs_room);
}

/// Looks which of those that request nothing live.
void Commanders::check_processes(bool needs_room) {
  constexpr int kEvery = 50;
  if (polls_++ % kEvery != 0 && !needs_room) return;
  for (CommanderState& state : states_) {
    if (state.requests()) continue;
    state.is_alive = owner_lives(regions_.stream_of(state.name), RegionKind::commander);
  }
}

void Commanders::read_newest(RequestRegions::Source& source, CommanderState& state,
                             Time now) noexcept {
  // A commander may read its clock after this process has.
  constexpr Time kMostAhead = std::chrono::seconds(1);
  std::array<Word, kCommanderRecordWords> words{};
  const RecordCopy copy = copy_record(source.control, words);
  source.seen = copy.sequence;
  const auto command = copy.is_whole ? command_of(words) : std::nullopt;
  if (command && command->time <= saturated_sum(now, kMostAhead)) {
    if (command->number != state.command.number) state.is_dead = false;
    state.command = *command;
    state.damaged_since = Time::max();
  } else if (!copy.is_unwritten()) {
    state.damaged_since = std::min(state.damaged_since, now);
  }
  state.is_damaged = now - kMostDamaged >= state.damaged_since;
  state.is_dead = state.is_dead || expiry_of(state.command) <= now;
}

void Commanders::read(Time now) {
  const auto sources = regions_.sources();
  for (std::size_t i = 0; i < sources.size(); ++i) read_newest(sources[i], states_[i], now);
}

core::RateRequest CommanderState::request(double largest, bool has_died) const noexcept {
  if (has_died || is_damaged) return {.rate = 0, .ramp = command.dead_man_ramp};
  return {.rate = requests() ? std::min(command.rate, largest) : largest, .ramp = command.ramp};
}

double least_rate(std::span<const CommanderState> states, double largest) noexcept {
  std::optional<double> least;
  for (const CommanderState& state : states) {
    if (!state.requests() && !state.is_damaged) continue;
    const double rate = state.request(largest).rate;
    least = std::min(least.value_or(rate), rate);
  }
  return std::min(least.value_or(1.0), largest);
}

void Commanders::wait(Time timeout) const noexcept {
  // There is one futex per region, and a thread can wait on one only.
  constexpr Time kSlice = std::chrono::milliseconds(1);
  if (calls()) return;
  if (regions_.sources().size() == 1) {
    const RequestRegions::Source& only = regions_.sources().front();
    wait_while_equal(only.control[kRecordSequence], only.seen, timeout);
  } else {
    std::this_thread::sleep_for(std::min(timeout, kSlice));
  }
}

Time Commanders::next_expiry() const noexcept {
  Time next = Time::max();
  for (const CommanderState& state : states_) {
    if (!state.is_dead) next = std::min(next, expiry_of(state.command));
    if (state.is_damaged || state.damaged_since == Time::max()) continue;
    next = std::min(next, saturated_sum(state.damaged_since, kMostDamaged));
  }
  return next;
}

}  // namespace splinecast::ipc
