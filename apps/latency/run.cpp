#include "apps/latency/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "apps/latency/roles.hpp"
#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/remover.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;

/// Runs the pipeline's processes. Returns their results, the producer's first.
std::vector<json> run_pipeline(const LatencyOptions& options, LatencyShared& shared) {
  const std::string stream = fmt::format("latency.{}", getpid());
  const StreamRemover remover({stream});
  std::vector<Child> children;
  children.emplace_back([&] { return run_latency_producer(options, stream, shared); });
  if (!options.embedded) {
    children.emplace_back([&] { return run_latency_solver(options, stream, shared); });
  }
  for (std::size_t r = 0; r < options.readers; ++r) {
    children.emplace_back([&, r] { return run_latency_reader(options, stream, shared, r); });
  }
  std::vector<json> returned;
  returned.reserve(children.size());
  for (Child& child : children) returned.push_back(child.result());
  return returned;
}

void note_processes(const std::vector<json>& returned, LatencyResult& result) {
  result.processes = nlohmann::ordered_json::array();
  for (const json& process : returned) {
    for (const json& warning : process["warnings"]) result.warnings.push_back(warning);
    nlohmann::ordered_json entry{{"role", process["role"]}};
    entry.update(nlohmann::ordered_json(process["usage"]));
    result.processes.push_back(std::move(entry));
    if (process.contains("solver")) result.solver = process["solver"];
  }
}

void warn_of_sharing(LatencyResult& result) {
  const LatencyOptions& options = result.options;
  const std::size_t cpus = usable_cpus();
  if (!options.spin || options.processes() <= cpus) return;
  result.warnings.push_back(fmt::format(
      "{} processes spin on {} CPUs: the figures measure how the scheduler shares the CPUs",
      options.processes(), cpus));
}

void warn_of_losses(const json& producer, LatencyResult& result) {
  const auto warn = [&](std::uint64_t count, const char* what) {
    if (count > 0) result.warnings.push_back(fmt::format("{} {}", count, what));
  };
  const auto by_missing = [](const Latencies& stage) { return stage.missing; };
  warn(std::ranges::max(result.stages, {}, by_missing).missing,
       "waypoints never arrived: they count as missed deadlines, but in no percentile");
  warn(producer["full"], "waypoints found the ring full: their append waited for the solver");
  warn(producer["unnamed_refusals"],
       "refusals came too fast to be named: these waypoints count as if they had arrived");
  if (result.interrupted) result.warnings.emplace_back("interrupted: fewer waypoints measured");
}

void measure_pipeline(LatencyResult& result) {
  LatencyShared shared(result.options);
  const std::vector<json> returned = run_pipeline(result.options, shared);
  result.interrupted = returned.front()["interrupted"];
  std::vector<std::span<const SeenStamp>> seen;
  seen.reserve(shared.seen.size());
  for (const auto& log : shared.seen) seen.push_back(log.entries());
  std::vector<ipc::Word> refused(shared.refused.entries().begin(), shared.refused.entries().end());
  std::ranges::sort(refused);
  const Time start(shared.meeting->start_ns.load(std::memory_order_relaxed));
  result.stages = latencies_of(shared.appends.entries(), shared.revisions.entries(), seen, refused,
                               result.options.measured(start));
  if (result.stages.front().intended.count() + result.stages.front().missing == 0) {
    if (stop_requested()) throw Interrupted("interrupted before the warm-up was over");
    throw Failure("nothing was measured: the run ended during the warm-up");
  }
  note_processes(returned, result);
  warn_of_sharing(result);
  warn_of_losses(returned.front(), result);
}

}  // namespace

std::string throttling_warning(const LatencyOptions& options, const Environment& environment) {
  if (!options.fifo || !options.spin) return {};
  const auto stopped = throttled_time(environment);
  if (!stopped) {
    return "unknown whether the kernel throttles SCHED_FIFO processes that spin "
           "(/proc/sys/kernel/sched_rt_runtime_us)";
  }
  if (*stopped == Time::zero()) return {};
  return fmt::format(
      "the kernel stops SCHED_FIFO processes that spin for {:g} ms of each {} us "
      "(sched_rt_runtime_us is {}), which the figures include; see 'splinecast doctor'",
      to_seconds(*stopped) * 1e3, environment.rt_period, environment.rt_runtime);
}

LatencyResult run_latency(const LatencyOptions& options) {
  catch_stop_signals();
  LatencyResult result{.options = options,
                       .environment = read_environment(),
                       .clock = measure_clock(),
                       .warnings = {},
                       .stages = {},
                       .floor = measure_floor(options),
                       .iceoryx = {},
                       .processes = {},
                       .solver = {}};
  if (stop_requested()) throw Interrupted("interrupted before it began");
  if (auto warning = throttling_warning(options, result.environment); !warning.empty()) {
    result.warnings.push_back(std::move(warning));
  }
  measure_pipeline(result);
  if (!options.iceoryx) {
    result.iceoryx.reason = "disabled by --no-iceoryx";
  } else if (stop_requested()) {
    result.iceoryx.reason = "interrupted";
  } else {
    result.iceoryx = measure_iceoryx(options);
    if (stop_requested()) result.iceoryx = {.seen = std::nullopt, .reason = "interrupted"};
  }
  result.interrupted = result.interrupted || stop_requested();
  return result;
}

}  // namespace splinecast::apps
