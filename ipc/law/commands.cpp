#include "ipc/law/commands.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// When a command expires; max() if it does not.
Time expiry_of(const RateCommand& command) noexcept {
  const bool expires = command.rate > 0 && command.dead_man > Time::zero();
  return expires ? saturated_sum(command.time, command.dead_man) : Time::max();
}

}  // namespace

std::optional<RateCommand> command_of(const RingItem& item) noexcept {
  const std::span<const double> values = item.waypoint().position;
  if (item.kind != ItemKind::waypoint || !is_finite(values)) return std::nullopt;
  const auto time = [](double seconds, Time least, Time most) {
    return seconds > 0 ? std::clamp(from_seconds(seconds), least, most) : least;
  };
  return RateCommand{.time = item.time,
                     .rate = values[0],
                     .ramp = time(values[1], kShortestRamp, kLongestRamp),
                     .dead_man = time(values[2], Time::zero(), kLongestRamp)};
}

ProducerOptions command_ring_options(const RegionAccess& access, const Trust& trust) {
  return {.dimensions = kCommandValues,
          .names = {"rate", "ramp", "dead man"},
          .units = {"", "s", "s"},
          .start = {.kind = ConditionKind::own, .value = {}},
          .limits = {.min_interval = Time(1), .max_interval = kLatestTime / 2},
          .capacity = 256,
          .access = access,
          .trust = trust};
}

bool Commanders::has(const std::string& name) const noexcept {
  return std::ranges::find(states_, name, &CommanderState::name) != states_.end();
}

void Commanders::look_around() {
  for (std::size_t i = rings_.size(); i-- > 0;) {
    if (!rings_[i]->ring.retired()) continue;
    rings_.erase(rings_.begin() + std::ptrdiff_t(i));
    states_.erase(states_.begin() + std::ptrdiff_t(i));
  }
  if (!folder_.has_changed() && !tries_again_) return;
  tries_again_ = false;
  for (const std::string& name : commander_names(law_)) {
    if (has(name)) continue;
    try {
      auto [region, header, layout] = open_ring(commander_stream(law_, name), false, trust_);
      if (header.dimensions != kCommandValues) continue;
      region.close_descriptor();
      rings_.push_back(std::make_unique<Ring>(std::move(region), layout));
      states_.push_back(
          {.name = name, .command = {.time = Time::min(), .rate = -1, .ramp = kShortestRamp}});
    } catch (const StreamError&) {
      tries_again_ = true;  // it was just removed, or belongs to another user
    }
  }
}

bool Commanders::calls() const noexcept {
  return std::ranges::any_of(rings_, [](const auto& ring) {
    return ring->ring.written(std::memory_order_seq_cst) != ring->seen;
  });
}

void Commanders::read_newest(Ring& ring, RateCommand& command) {
  // Another try reads a command that came meanwhile; the ring is far longer than that.
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    const Word written = ring.ring.written();
    if (written == ring.seen || written == 0) return;
    if (!ring.ring.observe(written - 1, item_)) continue;
    ring.seen = written;
    command = command_of(item_).value_or(command);
  }
}

void Commanders::read(Time now) {
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    read_newest(*rings_[i], states_[i].command);
    states_[i].is_dead = expiry_of(states_[i].command) <= now;
  }
}

core::RateRequest CommanderState::request(double largest) const noexcept {
  if (is_dead) return {.rate = 0, .ramp = kDeadManRamp};
  return {.rate = requests() ? std::min(command.rate, largest) : largest, .ramp = command.ramp};
}

double least_rate(std::span<const CommanderState> states, double largest) noexcept {
  std::optional<double> least;
  for (const CommanderState& state : states) {
    if (!state.requests()) continue;
    const double rate = state.request(largest).rate;
    least = std::min(least.value_or(rate), rate);
  }
  return std::min(least.value_or(1.0), largest);
}

void Commanders::wait(Time timeout) const noexcept {
  // There is one futex per ring, and a thread can wait on one only.
  constexpr Time kSlice = std::chrono::milliseconds(1);
  if (calls()) return;
  if (rings_.size() == 1) {
    wait_while_equal(rings_.front()->ring.written_word(), rings_.front()->seen, timeout);
  } else {
    std::this_thread::sleep_for(std::min(timeout, kSlice));
  }
}

Time Commanders::next_expiry() const noexcept {
  Time next = Time::max();
  for (const CommanderState& state : states_) {
    if (!state.is_dead) next = std::min(next, expiry_of(state.command));
  }
  return next;
}

}  // namespace splinecast::ipc
