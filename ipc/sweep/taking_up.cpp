#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/roles/law_server.hpp"
#include "ipc/sweep/many_streams.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// Whether a failed attempt may succeed later with the same files under the stream's name.
bool is_transient(const std::exception& error) noexcept {
  return dynamic_cast<const OutOfResources*>(&error) != nullptr ||
         dynamic_cast<const StreamBusy*>(&error) != nullptr ||
         dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
}

}  // namespace

/// Attaches to the next stream that is ready.
void StreamSweep::attach_next(const Clock& clock) {
  for (std::size_t tries = 0; tries < kTries && !to_attach_.empty(); ++tries) {
    const std::string stream = std::move(to_attach_.back());
    to_attach_.pop_back();
    const auto found = members_.find(stream);
    if (found == members_.end() || found->second.state == State::solved) continue;
    if (own(stream, found->second) && attach(stream, found->second, clock)) return;
  }
}

/// Acquires the stream's solver lock if no other process holds it. Returns whether this process
/// holds it now.
bool StreamSweep::own(const std::string& stream, Member& member) {
  if (member.waiting) return true;
  if (owned() >= most_owned_) {
    become(stream, member, State::no_descriptors, SweepNews::no_descriptors);
    return false;
  }
  try {
    // Checks before it locks, because the lock creates a file and there may be many streams that
    // cannot be solved.
    const bool is_new_law = LawServer::is_wanted(stream, regions_);
    if (!member.is_named && !is_new_law) {
      (void)look_at_region(stream, RegionKind::waypoints, options_.trust);
    }
    if (is_owned(stream, RegionKind::spline)) throw StreamBusy(stream);
    member.waiting = std::make_unique<Solver>(stream, options_);
    Internals::share(*member.waiting, regions_);
    return true;
  } catch (const StreamBusy&) {
    become(stream, member, State::elsewhere, SweepNews::elsewhere);
  } catch (const LawLost& error) {
    drop(stream, member, error);
  } catch (const NoSuchStream&) {
    must_list_again_ = true;  // it was just removed
  } catch (const std::exception& error) {
    drop(stream, member, error);
  }
  return false;
}

/// Attaches to the stream if it exists. Returns whether it did.
bool StreamSweep::attach(const std::string& stream, Member& member, const Clock& clock) {
  try {
    regions_.poll();  // a law begins with the requests that are there
    if (!member.waiting->attach(clock)) {
      const bool is_noted = std::ranges::find(moving_, stream) != moving_.end();
      if (member.waiting->due() < Time::max() && !is_noted) moving_.push_back(stream);
      become(stream, member, State::waiting, SweepNews::waiting);
      return false;
    }
    make_room();
  } catch (const std::exception& error) {
    drop(stream, member, error);
    return false;
  }
  if (member.state == State::postponed) next_retry_ = now_;
  served_.push_back({.solver = std::move(member.waiting)});
  watches_.push_back({.solver = Internals::watch(*served_.back().solver), .active = now_});
  is_any_unheld_ = is_any_unheld_ || !Internals::hold_region(*served_.back().solver);
  become(stream, member, State::solved, SweepNews::solving, served_.back().solver.get());
  return true;
}

/// Reserves memory for one more solved stream, so that attaching cannot fail half-way.
void StreamSweep::make_room() {
  const std::size_t needed = served_.size() + 1;
  if (calling_.capacity() >= needed) return;
  const std::size_t room = 2 * needed;
  served_.reserve(room);
  watches_.reserve(room);
  calling_.reserve(room);
}

/// Retries to acquire the region locks that another process still held when this one took over the
/// boards.
void StreamSweep::hold_regions() noexcept {
  is_any_unheld_ = false;
  for (const Served& served : served_) {
    if (!Internals::hold_region(*served.solver)) is_any_unheld_ = true;
  }
}

/// Stops solving a stream. After a failed step it is given up or postponed; else it has been
/// retired and waits for a new producer.
void StreamSweep::release(Served& served) {
  const auto found = members_.find(served.solver->stream());
  auto& [stream, member] = *found;
  if (!served.failure) {
    member.waiting = std::move(served.solver);
    become(stream, member, State::waiting, SweepNews::waiting);
    return;
  }
  served.solver.reset();
  try {
    std::rethrow_exception(served.failure);
  } catch (const std::exception& error) {
    drop(stream, member, error);
  }
}

/// Gives a stream up because of an error, or postpones it if the error may be temporary. A named
/// stream that is postponed keeps its lock.
void StreamSweep::drop(const std::string& stream, Member& member, const std::exception& error) {
  if (is_transient(error)) {
    if (!member.is_named) member.waiting.reset();
    next_retry_ = now_ + kRetry;
    become(stream, member, State::postponed, SweepNews::postponed, nullptr, error.what());
    return;
  }
  member.waiting.reset();
  member.files = files_of(stream);
  become(stream, member, State::given_up, SweepNews::given_up, nullptr, error.what());
}

}  // namespace splinecast::ipc
