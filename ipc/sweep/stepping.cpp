#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "ipc/roles/internals.hpp"
#include "ipc/sweep/many_streams.hpp"

namespace splinecast::ipc {
namespace {

constexpr Time kDiscoveryInterval = std::chrono::milliseconds(50);

}  // namespace

bool StreamSweep::sweep(const Clock& clock) {
  now_ = clock.now();
  try {
    regions_.poll();
    attach_waiting(clock);
  } catch (const std::exception&) {
    must_list_again_ = true;  // the process lacks memory or descriptors; solved streams continue
  }
  collect_calling();
  bool has_more = false;
  for (std::size_t i = 0; i < calling_.size(); ++i) {
    prefetch_next(i);
    has_more = serve(calling_[i], clock) || has_more;
  }
  if (has_detached_) release_detached();
  return has_more || !to_attach_.empty();
}

void StreamSweep::attach_waiting(const Clock& clock) {
  // Does not poll while there are streams to attach to: attaching creates files, and each of them
  // would trigger another poll.
  if (to_attach_.empty() && now_ >= next_poll_) {
    next_poll_ = now_ + kDiscoveryInterval;
    poll();
    // Limits the share of the time that polls take, for any number of files in the folder.
    constexpr int kShare = 20;
    next_poll_ = std::max(next_poll_, clock.now() + kShare * (clock.now() - now_));
  }
  if (!to_attach_.empty()) attach_next(clock);
}

/// Collects the streams that have work to do.
void StreamSweep::collect_calling() {
  const Word stoppers = regions_.stoppers().version();
  schedule_.begin(now_, std::exchange(stoppers_, stoppers) != stoppers);
  calling_.clear();
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    const bool is_read = schedule_.reads(i, watch.active, watch.solver.due() == Time::max());
    const bool calls = is_read && watch.solver.calls();
    const bool needs_step = calls || (watch.solver.is_due(now_) && !watch.solver.settle(now_));
    if (needs_step) calling_.push_back(i);
  }
  if (watches_.empty() || !calling_.empty()) schedule_.note_work();
}

/// Prefetches the memory for the steps after the i-th one while that one runs: with many streams
/// the caches hold nothing of a stream from one sweep to the next.
void StreamSweep::prefetch_next(std::size_t i) const noexcept {
  const auto ask = [&](std::size_t ahead, Internals::Stage stage) {
    if (i + ahead >= calling_.size()) return;
    Internals::prefetch(*served_[calling_[i + ahead]].solver, stage);
  };
  if (i + 4 < calling_.size()) __builtin_prefetch(served_[calling_[i + 4]].solver.get());
  ask(3, Internals::Stage::self);
  ask(2, Internals::Stage::parts);
  ask(1, Internals::Stage::stream);
}

/// Steps one stream. Returns whether it has more to do.
bool StreamSweep::serve(std::size_t index, const Clock& clock) {
  Served& served = served_[index];
  StepResult result;
  try {
    result = served.solver->step(clock);
  } catch (const std::exception&) {
    served.failure = std::current_exception();
  }
  if (served.failure || !served.solver->attached()) {
    has_detached_ = true;
    return false;
  }
  watches_[index] = {.solver = Internals::watch(*served.solver), .active = now_};
  served.news.report(*served.solver, notify_, scratch_);
  return result.missed || watches_[index].solver.has_items();
}

void StreamSweep::release_detached() {
  for (std::size_t i = served_.size(); i-- > 0;) {
    if (!served_[i].failure && served_[i].solver->attached()) continue;
    release(served_[i]);
    served_.erase(served_.begin() + static_cast<std::ptrdiff_t>(i));
    watches_.erase(watches_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  has_detached_ = false;
  // Looks in the next sweep, because a new stream may already have the name.
  must_list_again_ = true;
  next_poll_ = now_;
}

}  // namespace splinecast::ipc
