#include "solve.hpp"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <memory>
#include <set>

#include "splinecast/ipc/solver.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"
#include "support/signals.hpp"

namespace splinecast::apps {
namespace {

/// Longest sleep on one stream; a signal that comes just before a sleep waits this long.
constexpr core::Time kLongestWait = std::chrono::milliseconds(50);

/// Tells what becomes of each stream.
class Announcer {
 public:
  Announcer(bool quiet, bool waits_for_many) : quiet_(quiet), many_(waits_for_many) {}

  void waiting(const std::string& stream) const {
    if (!quiet_) say(fmt::format("'{}': waiting for a producer", stream));
  }
  void attached(const ipc::Solver& solver) const {
    if (quiet_) return;
    say(fmt::format("'{}': {}", solver.stream(), solver.took_over() ? "taken over" : "solving"));
    if (!solver.is_memory_locked() && !many_) {
      say(fmt::format("'{}': pages are not locked into memory (RLIMIT_MEMLOCK)", solver.stream()));
    }
  }
  void finished(const ipc::Solver& solver) const {
    if (quiet_) return;
    const ipc::Head& head = solver.head();
    say(fmt::format("'{}': finished; {} waypoints interpolated, {} items refused", solver.stream(),
                    head.knots, head.refused));
  }

 private:
  bool quiet_;
  bool many_;
};

/// One stream's solver and what has been told of it.
struct Served {
  ipc::Solver solver;
  bool was_attached = false;
  bool was_finished = false;

  /// Looks after the stream once. Returns whether there was anything to do.
  bool serve(const ipc::Clock& clock, const Announcer& announcer) {
    if (!solver.attached()) {
      if (was_attached) announcer.waiting(solver.stream());
      was_attached = solver.attach();
      was_finished = false;
      if (!was_attached) return false;
      announcer.attached(solver);
    }
    const ipc::StepResult result = solver.step(clock);
    if (solver.attached() && solver.head().finished && !was_finished) {
      was_finished = true;
      announcer.finished(solver);
    }
    return result.consumed > 0 || result.missed;
  }
};

}  // namespace

int run_solve(const SolveOptions& options) {
  catch_stop_signals();
  const ipc::MonotonicClock clock;
  const bool many = options.streams.size() > 1;
  const Announcer announcer(options.quiet, many);
  std::vector<Served> all;
  for (const std::string& stream : options.streams) {
    all.push_back({.solver = ipc::Solver(stream, options.solver)});
    announcer.waiting(stream);
  }
  while (!stop_requested()) {
    bool worked = false;
    std::erase_if(all, [&](Served& served) {
      try {
        worked = served.serve(clock, announcer) || worked;
        return false;
      } catch (const std::exception& error) {
        if (!many) throw;
        say(fmt::format("'{}': given up: {}", served.solver.stream(), error.what()));
        return true;
      }
    });
    if (all.empty()) return kFailed;
    if (worked) continue;
    if (many) {
      sleep_until(clock.now() + options.sweep);
    } else {
      all.front().solver.wait(kLongestWait);
    }
  }
  return all.size() == options.streams.size() ? kOk : kFailed;
}

namespace {

/// What concerns live streams.
void add_live_options(CLI::App& verb, ipc::SolverOptions& options) {
  verb.add_option_function<std::string>(
          "--freeze-ahead",
          [&options](const std::string& text) {
            options.freeze_ahead = positive_time("--freeze-ahead", text, TimeUnit::milliseconds);
          },
          "Leave alone what lies this long ahead of now (default 5)")
      ->type_name("MS");
  add_seconds(verb, "--history", options.history,
              "Keep what ended less than this ago; then consume no more (default 1)");
  verb.add_option_function<std::string>(
          "--max-acceleration",
          [&options](const std::string& text) {
            options.max_acceleration = core::parse_values(text);
            if (options.max_acceleration) return;
            throw CLI::ValidationError(
                "--max-acceleration",
                fmt::format("'{}' is no list of numbers such as 10 or 10,10,5", text));
          },
          "Largest acceleration of stop tails, splices, the first interval and the one behind a "
          "frozen knot: one number, or one per dimension; 0 for no limit")
      ->type_name("A,...");
}

}  // namespace

void add_solve(CLI::App& program, Action& action) {
  auto options = std::make_shared<SolveOptions>();
  auto* verb = program.add_subcommand("solve", "Turn the waypoints of streams into splines");
  verb->add_option("STREAM", options->streams, "Streams to solve, in one process")->required();
  add_solver_curve(*verb, options->solver);
  add_seconds(*verb, "--stop-time", options->solver.stop_time,
              "Time in which a stream that dries up comes to rest (default 0.25)");
  add_count(*verb, "--capacity", options->solver.capacity,
            "Segments that the board holds (default 4096; rounded up to a power of two)");
  add_live_options(*verb, options->solver);
  verb->add_flag("!--no-wake", options->solver.wake,
                 "Wake no waiting readers: for hosts where every reader polls");
  verb->add_option_function<std::string>(
          "--sweep",
          [options](const std::string& text) {
            options->sweep = positive_time("--sweep", text, TimeUnit::milliseconds);
          },
          "Pause between looks at several streams (default 1)")
      ->type_name("MS");
  verb->add_flag("--quiet", options->quiet, "Say nothing of what becomes of the streams");
  add_access(*verb, options->solver.access);
  add_trust(*verb, options->solver.trust);
  verb->callback([&action, options] {
    const std::set<std::string> distinct(options->streams.begin(), options->streams.end());
    if (distinct.size() != options->streams.size()) {
      throw CLI::ValidationError("STREAM", "a stream is named twice");
    }
    action = [options] { return run_solve(*options); };
  });
}

}  // namespace splinecast::apps
