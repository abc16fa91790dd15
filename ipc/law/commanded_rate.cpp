#include "ipc/law/commanded_rate.hpp"

#include <algorithm>
#include <span>

namespace splinecast::ipc {

CommandedRate::CommandedRate(double largest) : largest_(largest) {
  bounds_.reserve(kMostCommanders);
}

/// The entry with this id; null if there is none.
CommanderEntry* CommandedRate::find(Word id) noexcept {
  const auto found = std::ranges::find(planned_.commanders, id, &CommanderEntry::id);
  return found != planned_.commanders.end() ? &*found : nullptr;
}

/// Enters a commander with a constant bound; null if there is no free slot.
CommanderEntry* CommandedRate::enter(const CommanderState& state, double rate) noexcept {
  CommanderEntry* const entry = find(0);
  if (entry == nullptr) return nullptr;
  *entry = {.id = state.id, .bound = core::RateCurve(rate)};
  std::copy_n(state.name.begin(), std::min(state.name.size(), entry->name.size()),
              entry->name.begin());
  return entry;
}

double CommandedRate::plan_beginning(const Commanders& commanders) noexcept {
  planned_ = {};
  for (const CommanderState& state : commanders.states()) {
    if (!state.is_used()) continue;
    CommanderEntry* const entry = enter(state, state.request(largest_, state.is_dead).rate);
    if (entry == nullptr) break;
    entry->ramp = state.request(largest_, state.is_dead).ramp;
  }
  take_requests(commanders, Time::zero());
  write_table();
  planned_.curve = core::RateCurve(target());
  return target();
}

void CommandedRate::take_over(const core::RateCurve& curve, const CommanderTable& table) noexcept {
  in_force_ = {.commanders = {}, .table = table, .curve = curve};
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    in_force_.commanders[slot] =
        entry_of(entry_words(table, slot), largest_).value_or(CommanderEntry{});
  }
}

/// Takes the requests of all commanders, and continues the bounds of those that have made a new
/// one.
void CommandedRate::take_requests(const Commanders& commanders, Time t) noexcept {
  Time newest = Time::min();
  for (const CommanderState& state : commanders.states()) {
    CommanderEntry* entry = find(state.id);
    if (entry == nullptr && state.is_used()) entry = enter(state, largest_);
    if (entry == nullptr) continue;
    const bool is_same = entry->number == state.command.number;
    const bool is_dead = state.is_dead || (entry->is_dead && is_same);
    const bool is_new =
        !is_same || is_dead != entry->is_dead || state.is_damaged != entry->is_damaged;
    if (!is_new) continue;
    const core::RateRequest request = state.request(largest_, is_dead);
    const bool changes = request.rate != entry->bound.last_rate() || request.ramp != entry->ramp;
    entry->number = state.command.number;
    entry->asks = state.requests() || state.is_damaged;
    entry->is_dead = is_dead;
    entry->is_damaged = state.is_damaged;
    entry->renewed = state.command.time;
    entry->ramp = request.ramp;
    if (!changes) continue;
    entry->bound = core::bound_after(entry->bound, t, request);
    if (state.command.time < newest) continue;
    newest = state.command.time;
    planned_.ramp = request.ramp;
    planned_.slot = static_cast<std::uint8_t>(entry - planned_.commanders.data());
  }
}

/// Releases the commanders that have no region any more, and forgets those that are not used and
/// whose bounds have reached the largest rate.
void CommandedRate::forget(const Commanders& commanders, Time t) noexcept {
  for (CommanderEntry& entry : planned_.commanders) {
    if (entry.id == 0) continue;
    const auto& states = commanders.states();
    const auto state = std::ranges::find(states, entry.id, &CommanderState::id);
    if (state != states.end() && state->is_used()) continue;
    if (state == states.end() && entry.asks) {
      entry.asks = false;
      entry.bound = core::bound_after(entry.bound, t, {.rate = largest_, .ramp = entry.ramp});
    }
    const bool is_largest = entry.bound.last_rate() == largest_;
    if (is_largest && entry.bound.rest(t) == Time::zero()) entry = {};
  }
}

void CommandedRate::write_table() noexcept {
  for (std::size_t slot = 0; slot < kMostCommanders; ++slot) {
    write_entry(planned_.commanders[slot],
                std::span(planned_.table).subspan(slot * kCommanderWords).first<kCommanderWords>());
  }
}

/// The least rate that commanders request; 1, or the largest if that is less, if none requests one.
double CommandedRate::target() const noexcept {
  std::optional<double> least;
  for (const CommanderEntry& entry : planned_.commanders) {
    if (entry.id == 0 || !entry.asks) continue;
    least = std::min(least.value_or(largest_), entry.bound.last_rate());
  }
  return least.value_or(std::min(1.0, largest_));
}

std::optional<core::RateCurve> CommandedRate::plan(const Commanders& commanders, Time t) noexcept {
  planned_ = in_force_;
  forget(commanders, t);
  take_requests(commanders, t);
  write_table();
  bounds_.clear();
  for (const CommanderEntry& entry : planned_.commanders) {
    if (entry.id != 0) bounds_.push_back(entry.bound);
  }
  const auto curve = core::plan_rate(in_force_.curve, t, bounds_, target(), planned_.ramp);
  if (curve) planned_.curve = *curve;
  has_changes_ = curve.has_value() || planned_.table != in_force_.table;
  return curve;
}

}  // namespace splinecast::ipc
