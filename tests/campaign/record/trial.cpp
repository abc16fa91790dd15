#include "tests/campaign/record/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/stopper.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::campaign::record {

using std::chrono::milliseconds;

Trial::Trial(const RunPlan& plan, Tally& tally)
    : plan_(plan), tally_(tally), random_(plan.seed + 1), disk_(folder_.path("disk")) {}

Trial::~Trial() {
  sources_.clear();
  recorder_.reset();
  std::vector<std::string> streams{plan_.prefix + ".last"};
  for (const SourcePlan& source : plan_.sources) streams.push_back(source.stream);
  if (!plan_.law.empty()) streams.push_back(plan_.law);
  for (const std::string& stream : streams) {
    try {
      // A stop remains in force, also without a stream.
      for (const auto& stopper : ipc::requester_names(stream, ipc::RegionKind::stopper)) {
        (void)Stopper(stream, stopper).release();
      }
      remove_stream(stream);
    } catch (const StreamError&) {
      continue;  // its sender has removed it
    }
  }
}

void Trial::run() {
  if (plan_.is_late) start_sources();
  if (plan_.is_late) sleep(0.05, 0.5);
  start_recorder();
  if (!plan_.is_late) start_sources();
  while (has_time() && !apps::stop_requested()) attack();
  collect();
  if (remains_.is_complete) await_attached();
  if (!remains_.code) end_recorder();
  tally_.count(fmt::format("runs: {}", to_string(plan_.attack)));
  tally_.count("writes refused by a full disk", static_cast<std::uint64_t>(disk_.refused()));
  if (!apps::stop_requested()) RunCheck(plan_, remains_, folder_, tally_).run();
}

void Trial::start_sources() {
  Time longest{};
  for (const SourcePlan& source : plan_.sources) {
    longest = std::max(longest, source.length);
    sources_.push_back(
        std::make_unique<apps::Child>([&source] { return to_json(run_source(source)); }));
  }
  if (!plan_.law.empty()) {
    const std::uint64_t seed = random_.next();
    sources_.push_back(std::make_unique<apps::Child>(
        [this, seed, longest] { return to_json(run_law(plan_.law, seed, longest)); }));
  }
  end_ = clock_.now() + longest;
}

void Trial::start_recorder() {
  std::vector<std::string> arguments{"record", plan_.prefix + ".*", "-o", folder_.path("run.mcap"),
                                     "--json"};
  arguments.insert(arguments.end(), plan_.options.begin(), plan_.options.end());
  recorder_.emplace(arguments, folder_.path("recorder"), disk_.environment());
  if (!recorder_->await_message("recording to")) throw apps::Failure(recorder_->err());
}

void Trial::sleep(double least, double most) {
  const Time until = clock_.now() + from_seconds(random_.uniform(least, most));
  (void)apps::sleep_until(std::min(until, std::max(end_, clock_.now())));
}

void Trial::attack() {
  if (!plan_.is_late || is_attacked_) sleep(0.05, 0.5);
  const bool is_first = !is_attacked_;
  is_attacked_ = true;
  switch (plan_.attack) {
    case Attack::paused:
      return pause();
    case Attack::slow:
      return slow_down();
    case Attack::full:
      return fill();
    case Attack::full_at_end:
      return disk_.fill(static_cast<std::int64_t>(random_.below(200'000)));
    case Attack::killed:
      if (is_first) sleep(0, 1);
      return kill();
    case Attack::interrupted:
      return is_first ? interrupt() : sleep(0.1, 0.5);
    case Attack::dumps:
      return trigger();
    case Attack::rotated:
      return random_.chance(0.3) ? trigger() : sleep(0.1, 0.3);
    case Attack::renamed:
      return rename_file();
    case Attack::flooded:
      return disk_.slow_down(1);
    case Attack::none:
      return;
  }
}

void Trial::kill() {
  recorder_->signal(SIGKILL);
  remains_.was_killed = true;
  remains_.is_complete = false;
}

void Trial::pause() {
  recorder_->signal(SIGSTOP);
  const Time until = clock_.now() + from_seconds(random_.log_uniform(0.2, 3));
  (void)apps::sleep_until(until);
  recorder_->signal(SIGCONT);
  tally_.count("pauses of the recorder");
}

void Trial::slow_down() {
  disk_.slow_down(static_cast<std::int64_t>(random_.log_uniform(100e3, 2e6)));
  sleep(0.1, 1);
  if (random_.chance(0.5)) disk_.repair();
  tally_.count("slow disks");
}

void Trial::fill() {
  disk_.fill(static_cast<std::int64_t>(random_.below(200'000)));
  sleep(0.2, 1.5);
  disk_.repair();
  tally_.count("full disks");
}

/// Ends the recorder before the streams end.
void Trial::interrupt() {
  sleep(0, 1);
  const std::size_t how = random_.below(4);
  if (how == 1) disk_.slow_down(200'000);
  if (how == 2) disk_.fill(static_cast<std::int64_t>(random_.below(100'000)));
  if (how == 3) recorder_->signal(SIGSTOP);
  if (how > 0) sleep(0, 0.5);
  recorder_->signal(SIGINT);
  recorder_->signal(SIGCONT);
  if (how == 1) sleep(0, 0.5);
  if (how == 1) disk_.repair();
  remains_.is_complete = false;
  remains_.could_write = how != 2;
  await_end();
}

/// The recorder begins another file, once it notices.
void Trial::rename_file() {
  const auto files = folder_.recordings();
  std::error_code ignored;
  for (const std::string& path : files) {
    if (path.ends_with(".old.mcap")) continue;
    std::filesystem::rename(path, fmt::format("{}.{}.old.mcap", path, random_.below(1U << 30U)),
                            ignored);
  }
  tally_.count("files renamed", files.size());
  sleep(0.5, 1.5);
}

void Trial::trigger() {
  recorder_->signal(SIGUSR1);
  tally_.count("triggers");
}

/// Waits for the senders.
void Trial::collect() {
  for (const auto& source : sources_) {
    for (const Sent& sent : sent_from(source->result())) remains_.sent.push_back(sent);
  }
  remains_.could_write = remains_.could_write && plan_.attack != Attack::full_at_end;
  if (remains_.could_write) disk_.repair();
}

/// When the recorder has attached to a stream that is newer than all others, it has to those.
void Trial::await_attached() {
  const std::string stream = plan_.prefix + ".last";
  Producer producer(stream, {.clock = StreamClock::recorded});
  const std::array position{position_at(Time::zero(), 0, false)};
  (void)producer.append({.time = Time::zero(), .position = position});
  remains_.sent.push_back({.stream = stream,
                           .id = producer.stream_id(),
                           .items = producer.appended(),
                           .is_left = true});
  if (!recorder_->await_message(fmt::format("'{}': recording", stream))) {
    throw apps::Failure(fmt::format("the recorder has ended: {}", recorder_->err()));
  }
  // Most often it has then also noticed which streams were created again.
  (void)apps::sleep_until(clock_.now() + milliseconds(100));
}

void Trial::end_recorder() {
  recorder_->signal(SIGINT);
  await_end();
}

void Trial::await_end() {
  remains_.code = recorder_->wait();
  if (!remains_.code) throw apps::Failure("the recorder does not end");
  if (remains_.was_killed) return;
  if (*remains_.code != apps::kOk && *remains_.code != apps::kIncomplete) {
    throw apps::Failure(
        fmt::format("the recorder ended with {}: {}", *remains_.code, recorder_->err()));
  }
  remains_.report = nlohmann::json::parse(recorder_->out());
}

}  // namespace splinecast::campaign::record
