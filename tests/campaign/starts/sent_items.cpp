#include "tests/campaign/starts/sent_items.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "splinecast/errors.hpp"
#include "splinecast/status.hpp"

namespace splinecast::campaign::starts {
namespace {

/// As many as a ring of the campaign keeps, but for those that a call adds.
constexpr std::uint64_t kKept = 60;

}  // namespace

void SentItems::begin(const Producer& producer) {
  if (producer.stream_id() == stream_) return;
  sent_.clear();
  stream_ = producer.stream_id();
  restarts_ = facts_.events[static_cast<std::size_t>(Event::solver_restarts)];
}

void SentItems::note(const Producer& producer, std::optional<double> s, std::uint64_t followers) {
  const std::uint64_t item = producer.last_item();
  if (item + followers + 1 != producer.appended()) {
    facts_.breach(Breach::outcome, seed_,
                  fmt::format("last item {} + {} of {}", item, followers, producer.appended()));
  }
  if (followers > 0) sent_.push_back({.item = item});
  sent_.push_back({.item = item + followers, .s = s});
  while (sent_.size() > kKept) sent_.pop_front();
}

void SentItems::check(Producer& producer, bool is_over) {
  const bool is_one_solver =
      restarts_ == facts_.events[static_cast<std::size_t>(Event::solver_restarts)];
  for (Sent& sent : sent_) {
    const ItemOutcome found = producer.outcome(sent.item);
    const bool is_kept = is_one_solver && sent.item + kKept >= producer.appended();
    check(sent, found, is_over, is_kept);
    sent.was = found;
    facts_.count(Event::outcomes);
    if (found.kind == OutcomeKind::passed_over) facts_.count(Event::items_passed_over);
    if (found.kind == OutcomeKind::withdrawn) facts_.count(Event::items_withdrawn);
    if (found.kind == OutcomeKind::refused) facts_.count(Event::items_refused);
    if (found.kind == OutcomeKind::forgotten) facts_.count(Event::items_forgotten);
    if (found.way == OutcomeWay::entry) facts_.count(Event::items_entered);
  }
}

void SentItems::check(const Sent& sent, const ItemOutcome& found, bool is_over, bool is_kept) {
  const bool is_forgotten = found.kind == OutcomeKind::forgotten;
  const bool has_changed = sent.was && sent.was->is_final && found != *sent.was && !is_forgotten;
  const bool is_lost = is_forgotten && is_kept;
  const bool is_open = is_over && !is_known(found);
  if (has_changed || is_lost || is_open) {
    facts_.breach(Breach::outcome, seed_,
                  fmt::format("item {}: {}, was {}", sent.item, to_string(found),
                              sent.was ? to_string(*sent.was) : "not looked at"));
  }
  if (sent.s && found.is_final && found.time) compare(sent, found);
}

/// Compares the curve with a waypoint that is in force.
void SentItems::compare(const Sent& sent, const ItemOutcome& found) {
  constexpr double kRounding = 1e-6;
  const auto sampled = world_.position_at(*found.time, stream_);
  if (!sampled) return;
  const double away = world_.distance(world_.position(*sent.s), *sampled);
  if (away <= kRounding) return;
  facts_.breach(
      Breach::outcome, seed_,
      fmt::format("item {}: {}, but the curve is {} away", sent.item, to_string(found), away));
}

}  // namespace splinecast::campaign::starts
