#include "bench/harness/blocks.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace splinecast::bench {
namespace {

/// Benchmarks that run alternately, as a regular expression over their names, and the maximum
/// number of blocks.
struct Group {
  const char* names;
  int most_blocks = std::numeric_limits<int>::max();
};

/// A ratio compares two benchmarks of one group: a benchmark with several peers is in several
/// groups.
constexpr std::array kGroups = {
    Group{"^(floor/eval|sample|gsl/sample)/dims:1$"},
    Group{"^(floor/eval|sample|gsl/sample)/dims:3$"},
    Group{"^(floor/eval|sample|gsl/sample)/dims:6$"},
    Group{"^(floor/eval|sample|gsl/sample)/dims:7$|^sample_many/dims:7/"},
    Group{"^(floor/eval|sample|gsl/sample)/dims:16$"},
    Group{"^(floor/eval|sample|gsl/sample)/dims:32$"},
    Group{"^(floor/ping|sample/dims:7/writer:.*)/iterations"},
    Group{"^(sample_random|gsl/sample_random)/dims:7$"},
    Group{"^(append|gsl/append|makima/append)/dims:1(/|$)"},
    Group{"^(append|gsl/append|makima/append)/dims:3(/|$)"},
    Group{"^(append|gsl/append|makima/append)/dims:6(/|$)"},
    Group{"^(append|gsl/append|makima/append)/dims:7(/|$)"},
    Group{"^(append|gsl/append|makima/append)/dims:16(/|$)"},
    Group{"^(append|gsl/append|makima/append)/dims:32(/|$)"},
    Group{"^(append/dims:7/settle:8$|floor/ping/|publish/dims:7/readers:0$)"},
    Group{"^publish/dims:7/readers:(0|1)$"},
    Group{"^publish/dims:7/readers:(0|16)$"},
    Group{"^publish/dims:7/readers:(0|64)$"},
    Group{"^publish/dims:(1|3|6|16|32)/"},
    Group{"^(floor/ping|roundtrip/.*)/iterations"},
    Group{"^(roundtrip/(embedded|solver)|iceoryx/.*)/iterations"},
    Group{"^(parse|replay)/"},
    Group{"^attach/"},
    Group{"^plan/", 3},
    Group{"^sample/dims:7/beside:"},
    Group{"^board/", 1},
    // These take seconds per run.
    Group{"^streams:1000/busy:100Hz/iterations", 9},
    Group{"^streams:(10|1000)/idle/iterations", 3},
    Group{"^idle_append/", 3},
};

/// Prints each run, and keeps it.
class Keeper final : public benchmark::ConsoleReporter {
 public:
  explicit Keeper(nlohmann::json& runs) : ConsoleReporter(OO_Tabular), runs_(runs) {}

  bool ReportContext(const Context& context) override {
    // Printed once, not for every block.
    return has_context_ || (has_context_ = ConsoleReporter::ReportContext(context));
  }

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.error_occurred) throw std::runtime_error(run.error_message);
      const double unit = benchmark::GetTimeUnitMultiplier(run.time_unit) / 1e9;
      nlohmann::json kept = {{"name", run.run_name.function_name + tail_of(run)},
                             {"group", group},
                             {"block", block},
                             {"iterations", run.iterations},
                             {"real_ns", run.GetAdjustedRealTime() / unit},
                             {"cpu_ns", run.GetAdjustedCPUTime() / unit}};
      for (const auto& [name, counter] : run.counters) kept[name] = counter.value;
      runs_.push_back(std::move(kept));
    }
  }

  std::size_t group = 0;
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
  for (keeper.group = 0; keeper.group < kGroups.size(); ++keeper.group) {
    const Group& group = kGroups[keeper.group];
    const int times = std::min(blocks, group.most_blocks);
    for (keeper.block = 0; keeper.block < times; ++keeper.block) {
      if (benchmark::RunSpecifiedBenchmarks(&keeper, group.names) == 0) {
        throw std::logic_error(std::string("no benchmark matches ") + group.names);
      }
    }
  }
  std::ofstream file(out);
  file << nlohmann::json{{"machine", machine()}, {"blocks", blocks}, {"runs", runs}}.dump(1)
       << '\n';
  if (!file.flush()) throw std::runtime_error(out + " cannot be written");
}

}  // namespace splinecast::bench
