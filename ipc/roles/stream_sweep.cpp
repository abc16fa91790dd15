#include "ipc/roles/stream_sweep.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <utility>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::ipc {
namespace {

constexpr Time kLookAround = std::chrono::milliseconds(50);

/// Streams that are tried at once, and streams of other processes that are looked at each time.
/// When one of these has died, the rest follow at once: they were mostly the same process's.
constexpr std::size_t kTries = 16;

/// How often one of the streams that lack memory or descriptors is tried again; once one has
/// succeeded, the next look tries another.
constexpr Time kRetry = std::chrono::milliseconds(100);

/// Descriptors for all else that the process does.
constexpr std::size_t kOtherDescriptors = 32;

std::size_t most_streams(std::size_t descriptors_each) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const std::size_t all = limit.rlim_cur;
  return all > kOtherDescriptors ? (all - kOtherDescriptors) / descriptors_each : 0;
}

/// Whether what failed may succeed later without other files under the stream's name.
bool is_passing(const std::exception& error) noexcept {
  return dynamic_cast<const OutOfResources*>(&error) != nullptr ||
         dynamic_cast<const StreamBusy*>(&error) != nullptr ||
         dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
}

}  // namespace

StreamSweep::StreamSweep(const std::vector<std::string>& wanted, SolverOptions options, Tell tell,
                         Time pause)
    : options_(std::move(options)),
      tell_(std::move(tell)),
      most_owned_(most_streams(kDescriptorsPerStream)),
      pause_(pause),
      quiet_sweeps_(static_cast<std::size_t>(std::max<std::int64_t>(kQuietPause / pause, 1))) {
  for (const std::string& text : wanted) {
    if (is_pattern(text)) {
      patterns_.push_back(text);
      continue;
    }
    require_stream_name(text);
    members_[text].is_named = true;
  }
  Solver::require(options_);
  // Owned at once, and taken up one after the other by the sweeps.
  for (auto& [stream, member] : members_) {
    if (own(stream, member)) become(stream, member, State::waiting, SweepNews::waiting);
  }
}

Time StreamSweep::next_pause() const noexcept {
  return all_quiet_ ? std::max(pause_, kQuietPause) : pause_;
}

bool StreamSweep::sweep(const Clock& clock) {
  now_ = clock.now();
  try {
    take_up(clock);
  } catch (const std::exception&) {
    looks_again_ = true;  // the process lacks memory or descriptors; streams that are solved go on
  }
  collect_calling();
  bool has_more = false;
  for (std::size_t i = 0; i < calling_.size(); ++i) {
    prefetch_behind(i);
    has_more = serve(calling_[i], clock) || has_more;
  }
  if (has_detached_) release_detached();
  return has_more || !to_take_.empty();
}

void StreamSweep::take_up(const Clock& clock) {
  // Not while streams are being taken up: that makes files, for which it would look each time.
  if (to_take_.empty() && now_ >= next_look_) {
    next_look_ = now_ + kLookAround;
    look_around();
    // However many files others make there, the looks take a bounded share of the time.
    constexpr int kShare = 20;
    next_look_ = std::max(next_look_, clock.now() + kShare * (clock.now() - now_));
  }
  if (!to_take_.empty()) take_next(clock);
}

/// Notes which streams have something to do.
void StreamSweep::collect_calling() {
  ++sweeps_;
  const bool looks_at_all = all_quiet_;
  const Time quiet_since = now_ - kQuietAfter;
  all_quiet_ = !watches_.empty();
  calling_.clear();
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    const bool is_quiet = watch.active <= quiet_since && watch.solver.due() == Time::max();
    const bool is_looked_at = !is_quiet || looks_at_all || (sweeps_ + i) % quiet_sweeps_ == 0;
    all_quiet_ = all_quiet_ && is_quiet;
    const bool calls = is_looked_at && watch.solver.calls();
    const bool needs_step = calls || (watch.solver.is_due(now_) && !watch.solver.settle(now_));
    if (needs_step) calling_.push_back(i);
  }
  all_quiet_ = all_quiet_ && calling_.empty();
}

/// Asks for what the steps behind the i-th calling stream's go through, while that one is stepped:
/// of many streams nothing stays in the caches from one step to the next.
void StreamSweep::prefetch_behind(std::size_t i) const noexcept {
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
  tell_first_refusals(*served.solver);
  if (!served.was_finished && Internals::head(*served.solver).finished) {
    served.was_finished = true;
    tell(SweepNews::finished, served.solver->stream(), served.solver.get(), {});
  }
  return result.missed || watches_[index].solver.has_items();
}

void StreamSweep::tell_first_refusals(Solver& solver) noexcept {
  try {
    solver.first_refusals(refused_);
    for (const ItemRefusal& refusal : refused_) {
      tell_(SweepNews::refused, solver.stream(), &solver, to_string(refusal));
    }
    if (const auto excess = solver.first_excess()) {
      tell_(SweepNews::beyond_limits, solver.stream(), &solver, solver.in_words(*excess));
    }
  } catch (...) {
    return;  // as in tell()
  }
}

void StreamSweep::release_detached() {
  for (std::size_t i = served_.size(); i-- > 0;) {
    if (!served_[i].failure && served_[i].solver->attached()) continue;
    release(served_[i]);
    served_.erase(served_.begin() + static_cast<std::ptrdiff_t>(i));
    watches_.erase(watches_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  has_detached_ = false;
  // Now, as a stream may already be there again.
  looks_again_ = true;
  next_look_ = now_;
}

/// A stream that has been retired waits for a producer again; one whose step failed is given up.
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

void StreamSweep::look_around() {
  const bool has_changed = folder_.has_changed();
  if (has_changed || looks_again_) {
    looks_again_ = true;
    look_for_names();
    looks_again_ = false;
  }
  note_ends_of_motion();
  if (to_take_.empty()) look_elsewhere();
  if (to_take_.empty()) look_at_postponed();
  if (is_any_unheld_) hold_regions();
}

/// Notes which streams are to be taken up, and forgets those that patterns found and that have
/// gone.
void StreamSweep::look_for_names() {
  to_take_.clear();
  std::vector<std::string> standing = stream_names();
  std::erase_if(standing, [](const std::string& stream) {
    return !region_exists(stream, RegionKind::waypoints);
  });
  for (const std::string& stream : standing) {
    if (is_wanted(stream)) members_.try_emplace(stream);
  }
  std::erase_if(members_, [&](const auto& entry) {
    const auto& [stream, member] = entry;
    const bool stands = std::ranges::binary_search(standing, stream);
    if (member.state == State::solved || stands || member.is_named) return false;
    tell(SweepNews::gone, stream, nullptr, {});
    return true;
  });
  for (auto& [stream, member] : members_) {
    const bool stands = std::ranges::binary_search(standing, stream);
    if (may_be_taken(stream, member, stands)) to_take_.push_back(stream);
  }
  std::ranges::reverse(to_take_);
}

/// Streams whose earlier motion has ended are tried again: nothing else tells.
void StreamSweep::note_ends_of_motion() {
  std::erase_if(moving_, [&](const std::string& stream) {
    const auto found = members_.find(stream);
    if (found == members_.end() || !found->second.waiting) return true;
    const Time end = found->second.waiting->due();
    if (end > now_) return end == Time::max();
    to_take_.push_back(stream);
    return true;
  });
}

/// Whether a stream is to be tried now. One that was given up is tried once other files exist under
/// its names: then it is reported as another stream.
bool StreamSweep::may_be_taken(const std::string& stream, Member& member, bool stands) {
  if (!stands && !member.is_named) return false;
  if (member.state == State::given_up && files_of(stream) != member.files) {
    member.state = State::unowned;
  }
  return member.state == State::unowned || member.state == State::waiting ||
         member.state == State::no_descriptors;
}

StreamSweep::Files StreamSweep::files_of(const std::string& stream) {
  const auto status_of = [](const std::string& path) {
    struct stat status {};
    if (lstat(path.c_str(), &status) != 0) status = {};
    return status;
  };
  const auto lock = status_of(lock_path(stream, RegionKind::spline));
  return {status_of(region_path(stream, RegionKind::waypoints)).st_ino,
          status_of(region_path(stream, RegionKind::spline)).st_ino,
          lock.st_uid != geteuid() ? lock.st_ino : 0};
}

/// Looks whether streams of others have lost their solver, some each time.
void StreamSweep::look_elsewhere() {
  if (elsewhere_.empty()) {
    for (const auto& [stream, member] : members_) {
      if (member.state == State::elsewhere) elsewhere_.push_back(stream);
    }
  }
  for (std::size_t looks = 0; looks < kTries && !elsewhere_.empty(); ++looks) {
    const std::string stream = std::move(elsewhere_.back());
    elsewhere_.pop_back();
    const auto found = members_.find(stream);
    if (found == members_.end() || found->second.state != State::elsewhere) continue;
    if (is_owned(stream, RegionKind::spline)) continue;
    to_take_.push_back(stream);
    looks = 0;
  }
}

/// Takes up again the next of the streams that lacked memory or descriptors.
void StreamSweep::look_at_postponed() {
  if (now_ < next_retry_) return;
  next_retry_ = now_ + kRetry;
  const auto is_postponed = [](const auto& entry) {
    return entry.second.state == State::postponed;
  };
  auto next = std::find_if(members_.upper_bound(last_retried_), members_.end(), is_postponed);
  if (next == members_.end()) next = std::ranges::find_if(members_, is_postponed);
  if (next == members_.end()) return;
  to_take_.push_back(next->first);
  last_retried_ = next->first;
}

/// Boards whose region lock somebody kept from this process when it took them over.
void StreamSweep::hold_regions() noexcept {
  is_any_unheld_ = false;
  for (const Served& served : served_) {
    if (!Internals::hold_region(*served.solver)) is_any_unheld_ = true;
  }
}

/// Takes up the next stream that can be.
void StreamSweep::take_next(const Clock& clock) {
  for (std::size_t tries = 0; tries < kTries && !to_take_.empty(); ++tries) {
    const std::string stream = std::move(to_take_.back());
    to_take_.pop_back();
    const auto found = members_.find(stream);
    if (found == members_.end() || found->second.state == State::solved) continue;
    if (own(stream, found->second) && attach(stream, found->second, clock)) return;
  }
}

/// Becomes the stream's solver, unless another process is.
bool StreamSweep::own(const std::string& stream, Member& member) {
  if (member.waiting) return true;
  if (owned() >= most_owned_) {
    become(stream, member, State::no_descriptors, SweepNews::no_descriptors);
    return false;
  }
  try {
    // Looks before it locks, because the lock makes a file and there may be many streams that
    // cannot be solved.
    if (!member.is_named) (void)look_at_region(stream, RegionKind::waypoints, options_.trust);
    if (is_owned(stream, RegionKind::spline)) throw StreamBusy(stream);
    member.waiting = std::make_unique<Solver>(stream, options_);
    return true;
  } catch (const StreamBusy&) {
    become(stream, member, State::elsewhere, SweepNews::elsewhere);
  } catch (const NoSuchStream&) {
    looks_again_ = true;  // it has just gone
  } catch (const std::exception& error) {
    drop(stream, member, error);
  }
  return false;
}

/// Takes the stream up if it stands. Returns whether it did.
bool StreamSweep::attach(const std::string& stream, Member& member, const Clock& clock) {
  try {
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

/// Makes room for one more stream that is solved, so that taking it up cannot fail half-way.
void StreamSweep::make_room() {
  const std::size_t needed = served_.size() + 1;
  if (calling_.capacity() >= needed) return;
  const std::size_t room = 2 * needed;
  served_.reserve(room);
  watches_.reserve(room);
  calling_.reserve(room);
}

/// Gives a stream up for a reason, or postpones it if that may pass. A named one that is postponed
/// keeps its lock.
void StreamSweep::drop(const std::string& stream, Member& member, const std::exception& error) {
  if (is_passing(error)) {
    if (!member.is_named) member.waiting.reset();
    next_retry_ = now_ + kRetry;
    become(stream, member, State::postponed, SweepNews::postponed, nullptr, error.what());
    return;
  }
  member.waiting.reset();
  member.files = files_of(stream);
  become(stream, member, State::given_up, SweepNews::given_up, nullptr, error.what());
}

/// Notes what has become of a stream, and tells it if that is news.
void StreamSweep::become(const std::string& stream, Member& member, State state, SweepNews news,
                         const Solver* solver, std::string_view why) noexcept {
  const bool is_news = member.state != state;
  member.state = state;
  if (is_news) tell(news, stream, solver, why);
}

void StreamSweep::tell(SweepNews news, const std::string& stream, const Solver* solver,
                       std::string_view why) noexcept {
  try {
    tell_(news, stream, solver, why);
  } catch (...) {
    return;  // a message that fails changes nothing for the streams
  }
}

std::size_t StreamSweep::owned() const noexcept {
  const auto waiting = std::ranges::count_if(
      members_, [](const auto& entry) { return entry.second.waiting != nullptr; });
  return served_.size() + static_cast<std::size_t>(waiting);
}

bool StreamSweep::is_wanted(const std::string& stream) const {
  return std::ranges::any_of(patterns_,
                             [&](const std::string& pattern) { return matches(pattern, stream); });
}

}  // namespace splinecast::ipc
