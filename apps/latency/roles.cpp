#include "apps/latency/roles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <numbers>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/attach.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::apps {
namespace {

using ipc::Word;
using nlohmann::json;
using std::chrono::milliseconds;

/// Longest sleep of a process that waits for another one: the end of the run is seen after at most
/// this delay.
constexpr Time kLongestWait = milliseconds(50);
/// History that the solver keeps: just enough for a reader's late sample.
constexpr Time kHistory = milliseconds(100);
constexpr Time kTick = milliseconds(1);

/// The number of waypoints that are due in a time span, plus one.
std::size_t waypoints_in(const LatencyOptions& options, Time time) {
  return static_cast<std::size_t>(time / options.period()) + 1;
}

/// The ring holds the waypoints of one second: the producer can be this far ahead of the solver.
std::size_t ring_capacity(const LatencyOptions& options) {
  return std::bit_ceil(std::max<std::size_t>(1024, waypoints_in(options, std::chrono::seconds(1))));
}

SolverOptions solver_options(const LatencyOptions& options) {
  return {.settle = options.settle,
          .history = kHistory,
          .capacity = std::bit_ceil(
              std::max<std::size_t>(4096, 2 * waypoints_in(options, options.lead + kHistory))),
          .wake = !options.spin};
}

/// An upper bound of the number of revisions: one per item, plus twice the expected number of
/// revisions that only raise `settled_until`, one per half freeze-ahead.
std::size_t most_revisions(const LatencyOptions& options) {
  const Time all = options.warmup + options.duration + options.lead + kLatencyPatience;
  const Time settles = ipc::LiveOptions().settle_ahead / 4;
  return waypoints_in(options, all) + static_cast<std::size_t>(all / settles);
}

template <typename T>
void push(SharedLog<T>& log, const T& entry) {
  if (!log.push(entry)) throw Failure("a log of the measurement is full");
}

json report(const char* role, const std::vector<std::string>& warnings,
            const MeasuredUsage& usage) {
  return {{"role", role}, {"warnings", warnings}, {"usage", usage.json()}};
}

/// The solver's role, as a process or inside the producer's.
class LatencySolver {
 public:
  LatencySolver(const LatencyOptions& options, const std::string& stream, LatencyShared& shared)
      : solver_(stream, solver_options(options)), shared_(&shared) {}

  /// Returns false if there is no producer within kLatencyPatience.
  bool attach() {
    const Time end = clock_.now() + kLatencyPatience;
    while (!solver_.attach()) {
      if (clock_.now() > end || !sleep_until(clock_.now() + kTick)) return false;
    }
    shared_->revisions.touch();
    return true;
  }

  /// Returns whether there was work to do.
  bool step() {
    const StepResult result = solver_.step(clock_);
    if (result.published) {
      const Time published = clock_.now();
      const ipc::Summary& summary = ipc::Internals::summary(solver_);
      push(shared_->revisions, {.revision = summary.revision,
                                .consumed = summary.consumed,
                                .solved = summary.committed,
                                .published = published});
      if (summary.finished) {
        shared_->meeting->last_revision.store(summary.revision, std::memory_order_release);
      }
    }
    return result.consumed > 0 || result.missed;
  }

  [[nodiscard]] bool has_finished() const { return ipc::Internals::summary(solver_).finished; }
  void wait(Time timeout) { solver_.wait(timeout); }
  [[nodiscard]] json counters() const {
    const ipc::Summary& summary = ipc::Internals::summary(solver_);
    return {{"revisions", summary.revision},        {"deadline_misses", summary.deadline_misses},
            {"late_commits", summary.late_commits}, {"interpolated", summary.interpolated()},
            {"passed_over", summary.passed_over},   {"refused", summary.refused}};
  }

 private:
  MonotonicClock clock_;
  Solver solver_;
  LatencyShared* shared_;
};

class LatencyProducer {
 public:
  LatencyProducer(const LatencyOptions& options, const std::string& stream, LatencyShared& shared)
      : options_(options),
        shared_(&shared),
        producer_(stream, {.dimensions = options.dimensions, .capacity = ring_capacity(options)}),
        position_(options.dimensions) {
    if (options.embedded) {
      solver_ = std::make_unique<LatencySolver>(options, stream, shared);
      solver_->attach();
    }
    shared.appends.touch();
    if (!producer_.wait_for_solver(kLatencyPatience)) throw TimeOut("the solver did not attach");
  }

  json run(const std::vector<std::string>& warnings) {
    MeasuredUsage usage(*shared_->meeting, options_.warmup);
    const std::size_t others = options_.processes() - 1;
    const Schedule schedule = options_.schedule(shared_->meeting->begin(others));
    move_to(schedule.intended(0));
    apps::run(
        schedule, [&](Time instant) { return wait_until(instant); },
        [&](std::size_t k, Time intended) {
          send(intended);
          usage.look(intended);
          move_to(schedule.intended(k + 1));
        });
    json found = report(options_.embedded ? "producer and solver" : "producer", warnings, usage);
    finish();
    found["interrupted"] = stop_requested();
    found["full"] = full_;
    found["unnamed_refusals"] = unnamed_refusals_;
    if (solver_) found["solver"] = solver_->counters();
    return found;
  }

 private:
  bool wait_until(Time instant) {
    if (!solver_) return wait_for_instant(instant, options_.spin);
    for (Time now = clock_.now(); now < instant; now = clock_.now()) {
      if (stop_requested()) return false;
      if (!solver_->step() && !options_.spin) {
        solver_->wait(std::min(instant - now, kLongestWait));
      }
    }
    return !stop_requested();
  }

  /// Sines with a period of 2 s, each dimension with its own phase.
  void move_to(Time t) {
    time_ = t + options_.lead;
    const double turns = std::fmod(to_seconds(t), 2.0) / 2;
    for (std::size_t d = 0; d < position_.size(); ++d) {
      position_[d] = std::sin(2 * std::numbers::pi * turns + static_cast<double>(d));
    }
  }

  void send(Time intended) {
    AppendStamp stamp{.item = producer_.appended(), .intended = intended, .begun = clock_.now()};
    const Waypoint waypoint{.time = time_, .position = position_};
    AppendStatus status = producer_.append(waypoint);
    if (status == AppendStatus::full) ++full_;
    while (status == AppendStatus::full && !stop_requested()) {
      if (solver_) solver_->step();
      status = producer_.append(waypoint);
    }
    stamp.appended = clock_.now();
    if (status != AppendStatus::accepted) stamp.item = kRefusedItem;
    push(shared_->appends, stamp);
    if (solver_) solver_->step();
  }

  void finish() {
    const Condition halt{.kind = ConditionKind::halt, .value = {}};
    const Time end = clock_.now() + kLatencyPatience;
    while (producer_.finish(halt) == AppendStatus::full) pass_time(end);
    while (producer_.consumed() < producer_.appended()) pass_time(end);
    const Refusals refusals = producer_.refusals();
    unnamed_refusals_ = refusals.missed;
    for (const ItemRefusal& refused : refusals.items) push(shared_->refused, refused.item);
  }

  void pass_time(Time end) {
    if (clock_.now() > end) throw TimeOut("the solver makes no progress");
    if (solver_) {
      solver_->step();
    } else {
      (void)producer_.wait_for_room(kTick);  // or until something is consumed
    }
  }

  const LatencyOptions& options_;
  LatencyShared* shared_;
  MonotonicClock clock_;
  Producer producer_;
  std::unique_ptr<LatencySolver> solver_;
  Word unnamed_refusals_ = 0;
  Time time_{};
  std::vector<double> position_;
  std::size_t full_ = 0;
};

}  // namespace

bool Meeting::await_start() {
  ready.fetch_add(1, std::memory_order_relaxed);
  const MonotonicClock clock;
  const Time end = clock.now() + kLatencyPatience;
  while (start_ns.load(std::memory_order_relaxed) == 0) {
    if (clock.now() > end || !sleep_until(clock.now() + kTick)) return false;
  }
  return true;
}

Time Meeting::begin(std::size_t count) {
  const MonotonicClock clock;
  const Time end = clock.now() + kLatencyPatience;
  while (ready.load(std::memory_order_relaxed) < count) {
    if (clock.now() > end) throw TimeOut("a process of the measurement did not start");
    if (!sleep_until(clock.now() + kTick)) throw Interrupted("interrupted before it began");
  }
  constexpr Time kRunUp = milliseconds(20);
  const Time start = clock.now() + kRunUp;
  start_ns.store(start.count(), std::memory_order_relaxed);
  return start;
}

double bytes_noted(const LatencyOptions& options) {
  const auto revisions = static_cast<double>(most_revisions(options));
  return static_cast<double>(options.schedule({}).count * sizeof(AppendStamp)) +
         revisions * sizeof(RevisionStamp) +
         revisions * static_cast<double>(options.readers * sizeof(SeenStamp));
}

LatencyShared::LatencyShared(const LatencyOptions& options)
    : appends(options.schedule({}).count),
      revisions(most_revisions(options)),
      refused(ipc::kRefusalsKept) {
  for (std::size_t r = 0; r < options.readers; ++r) seen.emplace_back(most_revisions(options));
}

bool wait_for_instant(Time instant, bool spin) {
  if (!spin) return sleep_until(instant);
  const MonotonicClock clock;
  while (clock.now() < instant) {
    if (stop_requested()) return false;
  }
  return true;
}

json run_latency_producer(const LatencyOptions& options, const std::string& stream,
                          LatencyShared& shared) {
  const auto warnings = adopt(options.settings(options.cpu_producer), "the producer");
  return LatencyProducer(options, stream, shared).run(warnings);
}

json run_latency_solver(const LatencyOptions& options, const std::string& stream,
                        LatencyShared& shared) {
  const auto warnings = adopt(options.settings(options.cpu_solver), "the solver");
  MeasuredUsage usage(*shared.meeting, options.warmup);
  LatencySolver solver(options, stream, shared);
  if (!solver.attach()) throw TimeOut("there is no producer");
  if (!shared.meeting->await_start()) throw TimeOut("the producer did not start");
  const MonotonicClock clock;
  while (!stop_requested() && !solver.has_finished()) {
    if (solver.step()) {
      usage.look(clock.now());
    } else if (!options.spin) {
      solver.wait(kLongestWait);
    }
  }
  json found = report("solver", warnings, usage);
  found["solver"] = solver.counters();
  return found;
}

json run_latency_reader(const LatencyOptions& options, const std::string& stream,
                        LatencyShared& shared, std::size_t index) {
  const std::string role = options.readers == 1 ? "the reader" : fmt::format("reader {}", index);
  const auto warnings = adopt(options.settings(options.cpu_reader(index)), role);
  MeasuredUsage usage(*shared.meeting, options.warmup);
  SharedLog<SeenStamp>& log = shared.seen[index];
  log.touch();
  Reader reader = attach_reader(stream, kLatencyPatience);
  State state(reader.dimensions());
  if (!shared.meeting->await_start()) throw TimeOut("the producer did not start");
  const MonotonicClock clock;
  Word seen = 0;
  const auto is_over = [&] {
    const Word last = shared.meeting->last_revision.load(std::memory_order_acquire);
    return stop_requested() || (last != 0 && seen >= last);
  };
  for (bool again = false; !is_over();) {
    if (!options.spin && !again && reader.wait(kLongestWait) != WaitStatus::advanced) continue;
    again = reader.sample(clock.now(), state) == SampleStatus::busy;
    const Word revision = ipc::Internals::sampler(reader).revision_seen();
    if (again || revision <= seen) continue;
    const Time now = clock.now();
    push(log, {.revision = revision, .seen = now});
    seen = revision;
    usage.look(now);
  }
  return report(fmt::format("reader {}", index).c_str(), warnings, usage);
}

}  // namespace splinecast::apps
