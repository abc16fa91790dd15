#include "tests/campaign/kills/attacked_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <exception>
#include <filesystem>
#include <utility>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/kills/roles.hpp"

namespace splinecast::campaign {
namespace {

/// Polling interval of a wait.
constexpr Time kTick = std::chrono::microseconds(500);

constexpr std::size_t index_of(Role role) { return static_cast<std::size_t>(role); }

}  // namespace

AttackedStream::AttackedStream(Plan plan)
    : plan_(std::move(plan)), readers_(plan_.readers), moved_(clock_.now()) {
  start_solver();
  start_producer();
  for (std::size_t which = 0; which < readers_.size(); ++which) start_reader(which);
}

AttackedStream::~AttackedStream() {
  producer_.reset();
  solver_.reset();
  readers_.clear();
  remove_files();
}

void AttackedStream::start_solver() {
  solver_.emplace([this] {
    run_solver(plan_, *journal_);
    return nullptr;
  });
}
void AttackedStream::start_producer() {
  producer_.emplace([this] {
    run_producer(plan_, *journal_);
    return nullptr;
  });
}
void AttackedStream::start_reader(std::size_t which) {
  ReaderFacts& facts = journal_->readers[which];
  facts.life_samples = 0;
  readers_[which].moved = clock_.now();
  readers_[which].child.emplace([this, &facts] {
    run_reader(plan_, facts);
    return nullptr;
  });
}

void AttackedStream::tick() {
  observe();
  reap();
  const Time now = clock_.now();
  note_recoveries(now);
  if (!plan_.is_live() && summary_.finished && observed_id() != compared_id_ && !producer_) {
    end_life();
    is_ending_ = is_last_life_;
  }
  if (!is_ending_) restart();
  watch(now);
}

std::uint64_t AttackedStream::observed_id() const {
  return observer_ ? ipc::Internals::header(*observer_).stream_id : 0;
}

/// The stream's ring, if it exists.
std::optional<RingCheck> AttackedStream::ring() const {
  try {
    return RingCheck(plan_, journal_->observer);
  } catch (const NoSuchStream&) {
    return std::nullopt;
  }
}

void AttackedStream::observe() {
  has_sampled_ = false;
  try {
    if (!observer_) {
      summary_ = {};
      observer_.emplace(plan_.stream);
      check_.emplace(plan_, *observer_, journal_->observer);
    }
  } catch (const NoSuchStream&) {
    return;
  }
  const bool has_summary = ipc::Internals::summary(*observer_, summary_);
  const SampleStatus status = check_->peek(summary_.newest_time);
  has_sampled_ = has_summary && has_values(status);
  if (status != SampleStatus::retired) return;
  check_.reset();
  observer_.reset();
  summary_ = {};
}

void AttackedStream::reap() {
  std::erase_if(dying_, [](apps::Child& child) { return child.ended().has_value(); });
  reap(producer_, Role::producer);
  reap(solver_, Role::solver);
  for (Reading& reading : readers_) reap(reading.child, Role::reader);
}

/// Handles a process that ended without kill(): through its hook, with an error, or, for a
/// producer, because its stream is finished.
void AttackedStream::reap(std::optional<apps::Child>& child, Role role) {
  const auto code = child ? child->ended() : std::nullopt;
  if (!code) return;
  child.reset();
  if (*code == -SIGKILL) return note_kill(role);
  if (*code != 0) ++findings_.unusable;
}

bool AttackedStream::kill(Role role, std::size_t which) {
  auto& child = role == Role::producer ? producer_
                : role == Role::solver ? solver_
                                       : readers_[which].child;
  if (!child) return false;
  if (role == Role::solver) {
    // The kernel can take long to end it. The next one waits for its locks only.
    child->signal(SIGKILL);
    dying_.push_back(std::move(*child));
  }
  child.reset();
  if (role == Role::reader) killed_reader_ = which;
  note_kill(role);
  return true;
}

void AttackedStream::note_kill(Role role) {
  ++findings_.kills[index_of(role)];
  findings_.recovery[index_of(role)].begin(clock_.now());
  Mark& mark = marks_[index_of(role)];
  mark = {.stream_id = observed_id(), .count = summary_.consumed};
  if (role != Role::producer) return;
  if (auto left = ring()) {
    mark = {.stream_id = left->stream_id(), .count = left->appended()};
    // An item that it was writing when it died is among these.
    for (ipc::Word back = 0; back < left->capacity(); ++back) left->look(back);
  }
}

void AttackedStream::note_recoveries(Time now) {
  for (const Role role : {Role::producer, Role::solver}) {
    apps::Recovery& recovery = findings_.recovery[index_of(role)];
    if (!recovery.is_awaited() || !has_sampled_) continue;
    const Mark& mark = marks_[index_of(role)];
    if (observed_id() != mark.stream_id || summary_.consumed > mark.count) recovery.end(now);
  }
  apps::Recovery& recovery = findings_.recovery[index_of(Role::reader)];
  const bool is_back = readers_.empty() || (readers_[killed_reader_].child &&
                                            journal_->readers[killed_reader_].life_samples > 0);
  if (recovery.is_awaited() && is_back) recovery.end(now);
}

void AttackedStream::restart() {
  for (std::size_t which = 0; which < readers_.size(); ++which) {
    if (!readers_[which].child) start_reader(which);
  }
  if (!solver_) start_solver();
  if (!producer_ && may_produce()) start_producer();
}

/// A finished stream is recreated only after its end has been compared.
bool AttackedStream::may_produce() const {
  const auto left = ring();
  return !left || !left->is_finished() || left->stream_id() == compared_id_;
}

void AttackedStream::watch(Time now) {
  for (std::size_t which = 0; which < readers_.size(); ++which) {
    Reading& reading = readers_[which];
    const std::uint64_t turns = journal_->readers[which].turns;
    if (std::exchange(reading.turns, turns) != turns) reading.moved = now;
    if (!reading.child || now - reading.moved < kPatience) continue;
    count_hang(fmt::format("reader {} hangs", which));
    start_reader(which);
  }
  for (const Role role : {Role::producer, Role::solver, Role::reader}) {
    apps::Recovery& recovery = findings_.recovery[index_of(role)];
    if (!recovery.is_awaited() || now - *recovery.since() < kPatience) continue;
    count_hang(fmt::format("no new data after the kill of a {}", to_string(role)));
    recovery.forget();
  }
  const Mark progress{.stream_id = observed_id(), .count = summary_.consumed};
  if (progress.stream_id != progress_.stream_id || progress.count != progress_.count) moved_ = now;
  progress_ = progress;
  if (is_ending_ || now - moved_ < kPatience) return;
  count_hang("the solver makes no progress");
  moved_ = now;
}

void AttackedStream::count_hang(const std::string& what) {
  ++findings_.hangs;
  apps::say(fmt::format("'{}': {}; {} items consumed, {} accepted, revision {}", plan_.stream, what,
                        summary_.consumed, journal_->accepted.load(), summary_.revision));
}

bool AttackedStream::is_calm() const {
  const bool all_read = std::ranges::all_of(
      readers_, [](const Reading& reading) { return reading.child.has_value(); });
  return producer_ && solver_ && all_read &&
         std::ranges::none_of(findings_.recovery, &apps::Recovery::is_awaited);
}

/// Compares a finished and solved stream: all segments must exist and be those of an undisturbed
/// solve.
void AttackedStream::end_life() {
  count_items();
  const std::uint64_t before = journal_->observer.segments;
  if (const auto first = observer_->first_time()) check_->survey(*first, summary_.newest_time);
  if (journal_->observer.segments - before != plan_.reference.size() || summary_.refused > 0) {
    ++journal_->observer.wrong;
    apps::say(fmt::format("'{}': {} segments of {}, {} items refused", plan_.stream,
                          journal_->observer.segments - before, plan_.reference.size(),
                          summary_.refused));
  }
  compared_id_ = observed_id();
  journal_->accepted = 0;
  ++findings_.lives;
  if (removal_) remove_at_end();
}

/// Counts the items of a stream at its end: the ring holds exactly the accepted items, and each one
/// is a waypoint that was interpolated, passed over, refused with a reason or withdrawn, or a
/// control item that was executed.
void AttackedStream::count_items() {
  findings_.waypoints += summary_.interpolated();
  findings_.passed_over += summary_.passed_over;
  findings_.refused += summary_.refused;
  findings_.withdrawn += summary_.withdrawn;
  const auto left = ring();
  const ipc::Word appended = left ? left->appended() : 0;
  const ipc::Word accounted =
      summary_.knots + summary_.refused + summary_.withdrawn + summary_.controls;
  const ipc::Word most = std::max({appended, accounted, journal_->accepted.load()});
  const ipc::Word least = std::min(appended, accounted);
  if (most == least) return;
  findings_.lost += most - least;
  apps::say(
      fmt::format("'{}': {} items in the ring, {} reported as accepted, {} counted by the "
                  "solver",
                  plan_.stream, appended, journal_->accepted.load(), accounted));
}

void AttackedStream::remove_at_end() {
  if (solver_) kill(Role::solver);
  dying_.clear();
  std::optional<apps::Child> remover;
  remover.emplace([this] {
    run_remover(plan_, *journal_);
    return nullptr;
  });
  const Time end = clock_.now() + *removal_;
  removal_.reset();
  std::optional<int> code;
  while (!(code = remover->ended()) && clock_.now() < end) apps::sleep_until(clock_.now() + kTick);
  if (code && *code != 0 && *code != -SIGKILL) ++findings_.unusable;
  remover.reset();
  if (code == 0) return;
  ++findings_.kills[index_of(Role::remover)];
}

bool AttackedStream::tick_until(const std::function<bool()>& condition) {
  const Time end = deadline(clock_, kPatience);
  while (!condition()) {
    if (clock_.now() > end) return false;
    tick();
    apps::sleep_until(clock_.now() + kTick);
  }
  return true;
}

/// Sends SIGTERM to a process and waits for its end.
void AttackedStream::end(std::optional<apps::Child>& child) {
  if (!child) return;
  child->stop();
  std::optional<int> code;
  const Time end = deadline(clock_, kPatience);
  while (!(code = child->ended())) {
    if (clock_.now() > end) {
      count_hang("a process does not end");
      break;
    }
    apps::sleep_until(clock_.now() + kTick);
  }
  // A process that was just started may not have installed its handler of SIGTERM yet.
  if (code && *code != 0 && *code != -SIGTERM) ++findings_.unusable;
  child.reset();
}

Findings AttackedStream::finish() {
  (void)tick_until([this] { return is_calm(); });
  if (plan_.reference.empty()) {
    is_ending_ = true;
    end(producer_);
    const bool all_consumed = tick_until([this] {
      const auto left = ring();
      return left && summary_.consumed == left->appended() && summary_.finished == plan_.is_live();
    });
    if (!all_consumed) count_hang("the stream does not end");
    count_items();
    ++findings_.lives;
  } else {
    is_last_life_ = true;
    if (!tick_until([this] { return is_ending_; })) count_hang("the stream does not end");
  }
  end(solver_);
  for (Reading& reading : readers_) end(reading.child);
  for (std::size_t which = 0; which < readers_.size(); ++which) {
    findings_.add(journal_->readers[which]);
  }
  findings_.add(journal_->observer);
  remove_files();
  return findings_;
}

/// Removes the stream as `rm` does. No file may remain that must be removed by hand.
void AttackedStream::remove_files() {
  dying_.clear();
  check_.reset();
  observer_.reset();
  try {
    remove_stream(plan_.stream);
  } catch (const NoSuchStream&) {
    // already removed
  } catch (const std::exception& error) {
    apps::say(error.what());
    ++findings_.clean_ups;
  }
  for (const ipc::RegionKind kind : {ipc::RegionKind::waypoints, ipc::RegionKind::spline}) {
    for (const std::string& path :
         {ipc::region_path(plan_.stream, kind), ipc::lock_path(plan_.stream, kind)}) {
      if (std::filesystem::remove(path)) ++findings_.clean_ups;
    }
  }
}

}  // namespace splinecast::campaign
