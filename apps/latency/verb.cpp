#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>
#include <string>

#include "apps/cli/option_rows.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/files/numbers.hpp"
#include "apps/latency/compare.hpp"
#include "apps/latency/page.hpp"
#include "apps/latency/report.hpp"
#include "apps/latency/roles.hpp"
#include "apps/latency/run.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/timing/hgrm.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

constexpr double kMostRate = 100'000;
/// Waypoints of one measurement: their stamps are kept in memory, about 100 bytes each.
constexpr double kMostWaypoints = 1e7;
/// Bytes of all stamps. Revisions that only settle count too, 400 per second and more.
constexpr double kMostNoted = 2e9;
constexpr Time kLongestRun = std::chrono::hours(4);
constexpr Time kLongestLead = std::chrono::minutes(1);  ///< the board holds as much
constexpr int kMostCpus = 1024;
constexpr double kDefaultThreshold = 20;  // percent
constexpr double kDefaultFloor = 1;       // µs

struct LatencyCommand {
  LatencyOptions options;
  bool json = false;
  std::string hgrm;
  std::string report;
};

struct CompareCommand {
  std::string a;
  std::string b;
  double threshold = kDefaultThreshold;
  double floor_us = kDefaultFloor;
  bool json = false;
};

/// Throws InputError if SCHED_FIFO processes that spin have to share a CPU: a process does not
/// yield to one of the same priority, so two on one CPU would wait for each other forever.
void require_cpu_each(const LatencyOptions& options) {
  if (!options.fifo || !options.spin) return;
  std::set<int> distinct;
  std::size_t pinned = 0;
  const auto note = [&](const std::optional<int>& cpu) {
    if (!cpu) return;
    ++pinned;
    distinct.insert(*cpu);
  };
  note(options.cpu_producer);
  if (!options.embedded) note(options.cpu_solver);
  for (std::size_t r = 0; r < options.readers; ++r) note(options.cpu_reader(r));
  if (distinct.size() == pinned && options.processes() <= usable_cpus()) return;
  throw InputError(fmt::format(
      "--mode spin under --policy fifo needs one CPU per process: {} CPUs for {} processes",
      std::min(usable_cpus(), usable_cpus() - (pinned - distinct.size())), options.processes()));
}

void require_measurable(const LatencyOptions& options) {
  const double waypoints = options.rate * to_seconds(options.warmup + options.duration);
  if (waypoints > kMostWaypoints) {
    throw InputError(
        fmt::format("{:.0f} waypoints are more than {:.0f}, the maximum of a measurement",
                    waypoints, kMostWaypoints));
  }
  const double bytes = bytes_noted(options);
  if (bytes > kMostNoted) {
    throw InputError(fmt::format(
        "{} s with {} readers would record {:.0f} bytes; the maximum is {:.0f}: choose a shorter "
        "--duration",
        to_seconds(options.warmup + options.duration), options.readers, bytes, kMostNoted));
  }
  require_cpu_each(options);
}

void write_hgrm(const LatencyResult& result, const std::string& prefix) {
  for (const LatencySeries& series : series_of(result)) {
    if (series.histogram->count() == 0) continue;
    std::string name = fmt::format("{}.{}{}.hgrm", prefix, series.name,
                                   series.from == "raw" && series.name != "floor" ? ".raw" : "");
    std::ranges::replace(name, ' ', '-');
    Output output(name);
    output.write(percentile_text(*series.histogram));
    output.close();
  }
}

int run_latency_command(const LatencyCommand& command) {
  require_measurable(command.options);
  const LatencyResult result = run_latency(command.options);
  for (const std::string& warning : result.warnings) say("WARNING: " + warning);
  const ordered_json json = to_json(result);
  if (!command.hgrm.empty()) write_hgrm(result, command.hgrm);
  if (!command.report.empty()) {
    Output output(command.report);
    write_latency_page(result, output);
    output.close();
  }
  print_report(command.json ? json.dump(2) + "\n" : latency_text(json, isatty(STDOUT_FILENO) == 1));
  return result.interrupted ? kInterrupted : kOk;
}

ordered_json read_result(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file));
  try {
    return ordered_json::parse(in);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: not a result of 'splinecast latency --json': {}", file, error.what()));
  }
}

int run_compare(const CompareCommand& command) {
  constexpr double kNanoseconds = 1e3;
  const ordered_json a = read_result(command.a);
  const ordered_json b = read_result(command.b);
  try {
    const LatencyComparison found =
        compare_latencies(a, b, command.threshold, command.floor_us * kNanoseconds);
    print_report(command.json ? to_json(found).dump(2) + "\n" : comparison_text(found));
    return found.regressions() > 0 ? kFellShort : kOk;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{} or {}: {}", command.a, command.b, error.what()));
  }
}

int parse_cpu(const std::string& name, const std::string& text) {
  const auto cpu = parse_count(text);
  if (cpu && *cpu < kMostCpus) return static_cast<int>(*cpu);
  throw UsageError(name, fmt::format("'{}' is not a CPU number from 0 to {}", text, kMostCpus - 1));
}

void add_cpu(Command& verb, const std::string& name, std::optional<int>& cpu,
             const std::string& help) {
  verb.option(
          name, [&cpu, name](const std::string& text) { cpu = parse_cpu(name, text); }, help)
      .type("CPU");
}

/// Adds the options of what is sent.
void add_work(Command& verb, LatencyOptions& options) {
  add_rate(verb, "--rate", options.rate, "Waypoints per second, 1 to 100000 (default 1000)",
           {1, kMostRate});
  add_seconds(verb, "--duration", options.duration,
              "Duration of the measurement in s, above 0, at most 14400 (default 10)",
              {Time(1), kLongestRun});
  add_seconds(verb, "--warmup", options.warmup,
              "Duration of the warm-up in s, 0 to 14400 (default 1)", {Time::zero(), kLongestRun});
  add_milliseconds(verb, "--lead", options.lead,
                   "Time in ms from the append of a waypoint to its time, 0 to 60000 (default 200)",
                   {Time::zero(), kLongestLead});
  verb.option(
          "--deadline",
          [&options](const std::string& text) {
            options.deadline = time_within("--deadline", text, TimeUnit::milliseconds);
          },
          "Deadline in ms, above 0; a longer latency is a missed deadline (default: one period)")
      .type("MS");
  add_count(verb, "--dims", options.dimensions, "Number of dimensions, 1 to 64 (default 7)",
            {1, kMaxDimensions});
  add_curve_option<&SolverOptions::settle>(verb, options.settle, "K");
  add_count(verb, "--readers", options.readers, "Number of reader processes, 1 to 64 (default 1)",
            {1, 64});
  verb.flag("--embedded", options.embedded, "Solve in the producer's process");
}

/// Adds the options of the processes.
void add_processes(Command& verb, LatencyOptions& options) {
  add_choice(
      verb, "--mode", "spin", "wait", [&options](bool spin) { options.spin = spin; },
      "wait (default): sleep until there is work to do; spin: poll, with one CPU per process");
  add_cpu(verb, "--cpu-producer", options.cpu_producer, "CPU to pin the producer to, 0 to 1023");
  add_cpu(verb, "--cpu-solver", options.cpu_solver, "CPU to pin the solver to, 0 to 1023");
  verb.option(
          "--cpu-reader",
          [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              options.cpu_readers.push_back(parse_cpu("--cpu-reader", text));
            }
          },
          "CPUs to pin the readers to, 0 to 1023 each, assigned in turn")
      .separated_by_commas()
      .type("CPU,...");
  add_choice(
      verb, "--policy", "fifo", "other", [&options](bool fifo) { options.fifo = fifo; },
      "Scheduling policy: other (default), or fifo (SCHED_FIFO)");
  add_count(verb, "--prio", options.priority, "Priority with --policy fifo, 1 to 99 (default 50)",
            {1, 99});
  verb.flag("--mlock", options.lock_memory, "Lock all memory (mlockall)");
  verb.flag("--iceoryx", options.iceoryx,
            "Measure iceoryx too, and start its daemon for that (default: if it is built in)");
  verb.clear("--no-iceoryx", options.iceoryx, "Do not measure iceoryx");
}

/// Adds the subcommand `compare`, and returns it.
Command add_compare(Command& verb, const std::shared_ptr<CompareCommand>& command) {
  Command compare = verb.subcommand(
      "compare", "Compare two results of --json; exit code 3 if B is slower than A");
  compare.option("A", command->a, "File with the reference result of --json").required();
  compare.option("B", command->b, "File with the result of --json to compare with A").required();
  compare
      .option(
          "--threshold",
          [command](const std::string& text) {
            command->threshold = number_within("--threshold", text, {0, 1e6});
          },
          "Percent by which a percentile may be longer, 0 to 1e6 (default 20)")
      .type("PERCENT");
  compare
      .option(
          "--least",
          [command](const std::string& text) {
            command->floor_us = number_within("--least", text, {0, 1e9});
          },
          "Microseconds by which a slower percentile must be longer, 0 to 1e9 (default 1)")
      .type("US");
  compare.flag("--json", command->json, "Print JSON");
  return compare;
}

void add_latency(Command& verb, Action& action) {
  auto command = std::make_shared<LatencyCommand>();
  auto compared = std::make_shared<CompareCommand>();
  add_work(verb, command->options);
  add_processes(verb, command->options);
  verb.flag("--json", command->json, "Print JSON");
  verb.option("--hgrm", command->hgrm,
              "Write HdrHistogram percentile text, PREFIX.STAGE.hgrm for each stage")
      .type("PREFIX");
  verb.option("--report", command->report, "Write an HTML page with charts").type("OUT.html");
  const Command compare = add_compare(verb, compared);
  verb.callback([&action, compare, command, compared] {
    if (compare.is_chosen()) {
      action = [compared] { return run_compare(*compared); };
    } else {
      action = [command] { return run_latency_command(*command); };
    }
  });
}

const Verb latency_verb(
    "latency", 90,
    "Measure the latency from a producer's append to a reader's sample, between processes",
    add_latency);

}  // namespace

}  // namespace splinecast::apps
