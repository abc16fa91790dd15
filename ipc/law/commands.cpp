#include "ipc/law/commands.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <utility>

#include "ipc/layout/commander_control.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// When a command expires; max() if it does not.
Time expiry_of(const RateCommand& command) noexcept {
  const bool expires = command.rate > 0 && command.dead_man > Time::zero();
  return expires ? saturated_sum(command.time, command.dead_man) : Time::max();
}

}  // namespace

bool Commanders::has(const std::string& name) const noexcept {
  return std::ranges::find(states_, name, &CommanderState::name) != states_.end();
}

void Commanders::look_around(bool needs_room) {
  for (std::size_t i = sources_.size(); i-- > 0;) {
    if (load(sources_[i].control[kRetired], std::memory_order_acquire) == 0) continue;
    sources_.erase(sources_.begin() + std::ptrdiff_t(i));
    states_.erase(states_.begin() + std::ptrdiff_t(i));
  }
  look_for_life(needs_room);
  if (!has_news() && unusable_.empty()) return;
  unusable_.clear();
  for (const std::string& name : watch_->commanders_of(law_)) {
    if (has(name)) continue;
    try {
      const std::string stream = commander_stream(law_, name);
      auto [region, header, layout] = open_commander(stream, false, trust_);
      require_same_clock(header, stream);
      region.close_descriptor();
      const auto control = words_at(region.bytes(), layout.control, kCommanderControlWords);
      sources_.push_back({.region = std::move(region), .control = control});
      states_.push_back({.name = name, .id = header.stream_id});
    } catch (const NoSuchStream&) {
      continue;  // it was just removed
    } catch (const StreamError& error) {
      unusable_.push_back({.name = name, .why = error.what()});
    }
  }
  seen_ = watch_->commanders_version();
}

/// Looks which of those that request nothing live.
void Commanders::look_for_life(bool needs_room) {
  constexpr int kEvery = 50;
  if (looks_++ % kEvery != 0 && !needs_room) return;
  for (CommanderState& state : states_) {
    if (state.requests()) continue;
    state.is_alive = owner_lives(commander_stream(law_, state.name), RegionKind::commander);
  }
}

bool Commanders::calls() const noexcept {
  return has_news() || std::ranges::any_of(sources_, [](const Source& source) {
           return load(source.control[kCommanderSequence], std::memory_order_seq_cst) !=
                  source.seen;
         });
}

void Commanders::read_newest(Source& source, CommanderState& state, Time now) noexcept {
  // A commander may read its clock after this process has.
  constexpr Time kMostAhead = std::chrono::seconds(1);
  const CommandCopy copy = copy_command(source.control);
  source.seen = copy.sequence;
  const bool is_first = copy.is_whole && copy.sequence == 0;  // nothing requested yet
  const auto command = copy.is_whole ? command_of(copy.words) : std::nullopt;
  if (command && command->time <= saturated_sum(now, kMostAhead)) {
    if (command->number != state.command.number) state.is_dead = false;
    state.command = *command;
    source.damaged_since = Time::max();
  } else if (!is_first) {
    source.damaged_since = std::min(source.damaged_since, now);
  }
  state.is_damaged = now - kMostDamaged >= source.damaged_since;
  state.is_dead = state.is_dead || expiry_of(state.command) <= now;
}

void Commanders::read(Time now) {
  for (std::size_t i = 0; i < sources_.size(); ++i) read_newest(sources_[i], states_[i], now);
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
  if (sources_.size() == 1) {
    const Source& only = sources_.front();
    wait_while_equal(only.control[kCommanderSequence], only.seen, timeout);
  } else {
    std::this_thread::sleep_for(std::min(timeout, kSlice));
  }
}

Time Commanders::next_expiry() const noexcept {
  Time next = Time::max();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (!states_[i].is_dead) next = std::min(next, expiry_of(states_[i].command));
    if (states_[i].is_damaged || sources_[i].damaged_since == Time::max()) continue;
    next = std::min(next, saturated_sum(sources_[i].damaged_since, kMostDamaged));
  }
  return next;
}

}  // namespace splinecast::ipc
