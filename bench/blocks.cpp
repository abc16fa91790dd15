#include "blocks.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace splinecast::bench {
namespace {

/// Groups of benchmarks whose times are compared, as regular expressions over their names.
constexpr std::array kGroups = {
    "^(floor/eval|sample|gsl/sample)/dims:1$",
    "^(floor/eval|sample|gsl/sample)/dims:3$",
    "^(floor/eval|sample|gsl/sample)/dims:6$",
    "^(floor/eval|sample|gsl/sample)/dims:7$",
    "^(floor/eval|sample|gsl/sample)/dims:16$",
    "^(floor/eval|sample|gsl/sample)/dims:32$",
    "^sample/dims:7/writer:.*",
    "^(sample_random|gsl/sample_random)/dims:7$",
    "^(append|gsl/append|makima/append)/dims:1(/|$)",
    "^(append|gsl/append|makima/append)/dims:3(/|$)",
    "^(append|gsl/append|makima/append)/dims:6(/|$)",
    "^(append|gsl/append|makima/append)/dims:7(/|$)",
    "^(append|gsl/append|makima/append)/dims:16(/|$)",
    "^(append|gsl/append|makima/append)/dims:32(/|$)",
    "^publish/.*",
    "^(floor/ping|roundtrip/.*|iceoryx/.*)",
    "^(parse|replay)/.*",
};

/// What takes seconds a run; its times are compared with nothing, and three blocks are enough.
constexpr const char* kStreams = "^streams:(10/idle|1000/idle|1000/busy:100Hz)/iterations";
constexpr int kStreamBlocks = 3;

/// Shows each run, and keeps it.
class Keeper final : public benchmark::ConsoleReporter {
 public:
  explicit Keeper(nlohmann::json& runs) : ConsoleReporter(OO_Tabular), runs_(runs) {}

  bool ReportContext(const Context& context) override {
    // Once, not with every block.
    return has_context_ || (has_context_ = ConsoleReporter::ReportContext(context));
  }

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.error_occurred) throw std::runtime_error(run.error_message);
      const double unit = benchmark::GetTimeUnitMultiplier(run.time_unit) / 1e9;
      nlohmann::json kept = {{"name", run.run_name.function_name + tail_of(run)},
                             {"block", block},
                             {"iterations", run.iterations},
                             {"real_ns", run.GetAdjustedRealTime() / unit},
                             {"cpu_ns", run.GetAdjustedCPUTime() / unit}};
      for (const auto& [name, counter] : run.counters) kept[name] = counter.value;
      runs_.push_back(std::move(kept));
    }
  }

  int block = 0;

 private:
  static std::string tail_of(const Run& run) {
    return run.run_name.args.empty() ? "" : '/' + run.run_name.args;
  }

  nlohmann::json& runs_;
  bool has_context_ = false;
};

nlohmann::json machine() {
  const benchmark::CPUInfo& cpu = benchmark::CPUInfo::Get();
  nlohmann::json caches = nlohmann::json::array();
  for (const auto& cache : cpu.caches) {
    caches.push_back({{"level", cache.level}, {"type", cache.type}, {"bytes", cache.size}});
  }
  return {{"cores", cpu.num_cpus}, {"caches", std::move(caches)}, {"load", cpu.load_avg}};
}

}  // namespace

void run_blocks(int blocks, const std::string& out) {
  nlohmann::json runs = nlohmann::json::array();
  Keeper keeper(runs);
  const auto run = [&](const char* group, int times) {
    for (keeper.block = 0; keeper.block < times; ++keeper.block) {
      benchmark::RunSpecifiedBenchmarks(&keeper, group);
    }
  };
  for (const char* const group : kGroups) run(group, blocks);
  run(kStreams, std::min(blocks, kStreamBlocks));
  std::ofstream file(out);
  file << nlohmann::json{{"machine", machine()}, {"blocks", blocks}, {"runs", runs}}.dump(1)
       << '\n';
  if (!file.flush()) throw std::runtime_error(out + " cannot be written");
}

}  // namespace splinecast::bench
