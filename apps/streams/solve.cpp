#include "apps/streams/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/cli/option_rows.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/limits/file.hpp"
#include "apps/process/descriptors.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/report.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/sweep/many_streams.hpp"

namespace splinecast::apps {
namespace {

/// Longest sleep while one stream is solved. A signal that arrives just before a sleep is noticed
/// after at most this time.
constexpr Time kLongestWait = std::chrono::milliseconds(50);

constexpr TimeRange kSweeps{Time(1), std::chrono::seconds(1)};

/// Prints messages about the state of each stream.
class Announcer {
 public:
  Announcer(const SolveOptions& options, bool is_one_of_many)
      : quiet_(options.quiet),
        many_(is_one_of_many),
        limits_(&options.limits),
        joints_(options.solver.named_limits) {
    for (NamedLimits& joint : joints_) joint.name = ipc::header_name(joint.name);
  }

  void notify(ipc::SweepNews news, const std::string& stream, const Solver* solver,
              std::string_view why) {
    using enum ipc::SweepNews;
    const bool is_lost = news == no_descriptors || news == postponed || news == given_up;
    if (is_lost) lost_.insert(stream);
    if (news == solving) lost_.erase(stream);
    if (quiet_ && !is_lost && news != commander) return;
    say(fmt::format("'{}': {}", stream, text(news, solver, why)));
    if (news == solving && limits_->any()) report_limits(stream, *solver);
    if (news == solving && !many_ && !solver->is_memory_locked()) {
      say(fmt::format("'{}': pages are not locked into memory (RLIMIT_MEMLOCK)", stream));
    }
  }

  /// Whether a requested stream is not solved.
  [[nodiscard]] bool has_lost() const { return !lost_.empty(); }

 private:
  [[nodiscard]] static std::string text(ipc::SweepNews news, const Solver* solver,
                                        std::string_view why) {
    switch (news) {
      case ipc::SweepNews::waiting:
        return "waiting for a producer";
      case ipc::SweepNews::solving:
        return solver->took_over() ? "taken over" : "solving";
      case ipc::SweepNews::finished:
        return finished_in_words(*solver);
      case ipc::SweepNews::elsewhere:
        return "solved by another process";
      case ipc::SweepNews::no_descriptors:
        return fmt::format(
            "left out: RLIMIT_NOFILE allows {} file descriptors, a stream needs {} "
            "(ulimit -Hn)",
            descriptor_limit(), ipc::StreamSweep::kDescriptorsPerStream);
      case ipc::SweepNews::refused:
        return fmt::format("{}; further ones for this reason are only counted", why);
      case ipc::SweepNews::beyond_limits:
        return excess_in_words(*solver, why);
      case ipc::SweepNews::following:
        return following_in_words(ipc::Internals::summary(*solver));
      case ipc::SweepNews::commander:
        return std::string(why);
      case ipc::SweepNews::postponed:
        return fmt::format("postponed, will be retried: {}", why);
      case ipc::SweepNews::given_up:
        return fmt::format("given up: {}", why);
      case ipc::SweepNews::gone:
        return "gone";
    }
    return {};
  }

  [[nodiscard]] static std::string finished_in_words(const Solver& solver) {
    const ipc::Summary& summary = ipc::Internals::summary(solver);
    const auto worst = ipc::Internals::worst_excess(solver);
    return fmt::format("finished; {} waypoints interpolated{}, {} items refused{}{}",
                       summary.interpolated(), passed_over_in_words(summary.passed_over),
                       summary.refused,
                       worst ? fmt::format("; the largest of {} excesses: {}", summary.exceeding,
                                           solver.in_words(*worst))
                             : "",
                       end_in_words(summary));
  }

  [[nodiscard]] static std::string excess_in_words(const Solver& solver, std::string_view why) {
    const bool is_kept = ipc::beyond(ipc::Internals::board(solver)) == Beyond::enter;
    return fmt::format("{}, {}; further ones are only counted",
                       is_kept ? "left the spline to keep a limit" : "limit exceeded", why);
  }

  /// Reports limits that match no dimension, and dimensions without a limit.
  void report_limits(const std::string& stream, const Solver& solver) const {
    const ipc::RegionHeader& header = ipc::Internals::board(solver);
    const std::vector<std::string> names = ipc::dimension_names(header);
    const LimitGaps gaps =
        limit_gaps(ipc::motion_limits(header), joints_, names, ipc::dimensions_of(header));
    for (const std::string& line : to_lines(gaps)) say(fmt::format("'{}': {}", stream, line));
  }

  bool quiet_;
  bool many_;
  const LimitOptions* limits_;
  std::vector<NamedLimits> joints_;
  std::set<std::string> lost_;
};

/// Solves one stream. Sleeps on its ring while it has no work to do.
int solve_one(const SolveOptions& options) {
  const MonotonicClock clock;
  Announcer announcer(options, false);
  Solver solver(options.wanted.front(), options.solver);
  const ipc::NotifyNews notify = [&announcer](const auto&... news) { announcer.notify(news...); };
  notify(ipc::SweepNews::waiting, solver.stream(), &solver, {});
  bool was_attached = false;
  ipc::ReportedNews reported;
  ipc::ReportedNews::Scratch scratch;
  while (!stop_requested()) {
    if (!solver.attached()) {
      if (was_attached) notify(ipc::SweepNews::waiting, solver.stream(), &solver, {});
      was_attached = solver.attach(clock);
      reported = {};
      if (was_attached) notify(ipc::SweepNews::solving, solver.stream(), &solver, {});
    }
    const StepResult result = solver.step(clock);
    reported.report(solver, notify, scratch);
    if (result.consumed == 0 && !result.missed) solver.wait(kLongestWait);
  }
  return kOk;
}

/// Solves many streams. Polls them in sweeps.
int solve_many(const SolveOptions& options) {
  const MonotonicClock clock;
  raise_descriptor_limit();
  Announcer announcer(options, true);
  ipc::StreamSweep sweep(
      options.wanted, options.solver,
      [&announcer](const auto&... news) { announcer.notify(news...); }, options.sweep);
  Time due = clock.now();
  while (!stop_requested()) {
    if (sweep.sweep(clock)) continue;
    due = std::max(due + sweep.next_pause(), clock.now());
    sleep_until(due);
  }
  return announcer.has_lost() ? kFailed : kOk;
}

}  // namespace

int run_solve(const SolveOptions& options) {
  const bool is_one = options.wanted.size() == 1 && !ipc::is_pattern(options.wanted.front());
  return is_one ? solve_one(options) : solve_many(options);
}

namespace {

/// Adds the options of live streams.
void add_live_options(Command& verb, SolverOptions& options) {
  add_curve_option<&SolverOptions::freeze_ahead>(verb, options.freeze_ahead, "MS",
                                                 TimeUnit::milliseconds);
  add_curve_option<&SolverOptions::history>(verb, options.history, "SECONDS");
  add_curve_option<&SolverOptions::largest_rate>(verb, options.largest_rate, "R");
}

/// Adds the option of a process that solves several streams.
void add_sweep(Command& verb, SolveOptions& options) {
  verb.option(
          "--sweep",
          [&options](const std::string& text) {
            options.sweep = time_within("--sweep", text, TimeUnit::milliseconds, kSweeps);
          },
          "Pause between sweeps over several streams, in ms, 1e-6 to 1000 (default 1); idle "
          "streams, with no activity for 1 s, are polled every 20 ms, or every pause if that is "
          "longer")
      .type("MS");
}

/// Reads the file of limits and passes all limits to the solver.
void take_limits(SolveOptions& options) {
  if (options.limits.given != MotionLimits{}) options.solver.limits = options.limits.given;
  if (options.limits.file.empty()) return;
  LimitFile file = read_limit_file(options.limits.file);
  if (!options.quiet) std::ranges::for_each(file.notes, say);
  options.solver.named_limits = std::move(file.joints);
}

void add_solve(Command& verb, Action& action) {
  auto options = std::make_shared<SolveOptions>();
  verb.option(
          "STREAM", options->wanted,
          "Streams to solve in one process: names, and patterns such as 'arm.*', which also match "
          "streams that appear later")
      .required();
  add_solver_curve(verb, options->solver);
  add_curve_option<&SolverOptions::stop_time>(verb, options->solver.stop_time, "SECONDS");
  add_curve_option<&SolverOptions::capacity>(verb, options->solver.capacity, "N");
  add_live_options(verb, options->solver);
  add_limit_options(
      verb, options->limits,
      ". Applies to entries and stop segments, not to the spline through the waypoints: "
      "see --beyond");
  add_curve_option<&SolverOptions::beyond>(verb, options->solver.beyond, "report|refuse|enter");
  verb.clear("--no-wake", options->solver.wake,
             "Do not wake waiting readers: for hosts where every reader polls");
  add_sweep(verb, *options);
  verb.flag("--quiet", options->quiet,
            "Print no messages about streams, except those that cannot be solved, and commanders "
            "of time laws that are not heard or hold one unasked");
  add_access(verb, options->solver.access);
  add_trust(verb, options->solver.trust);
  verb.callback([&action, options] {
    const std::set<std::string> distinct(options->wanted.begin(), options->wanted.end());
    if (distinct.size() != options->wanted.size()) {
      throw UsageError("STREAM", "a stream is named twice");
    }
    action = [options] {
      take_limits(*options);
      catch_stop_signals();
      return run_solve(*options);
    };
  });
}

const Verb solve_verb("solve", 20, "Compute splines from the waypoints of streams", add_solve);

}  // namespace

}  // namespace splinecast::apps
