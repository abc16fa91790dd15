#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "apps/process/child.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/record/trial.hpp"

namespace splinecast::campaign {
namespace {

using record::Tally;

/// Runs in processes of their own, several at a time.
class Runs {
 public:
  void start(std::uint64_t seed) {
    running_.emplace_back(seed, std::make_unique<apps::Child>([seed] {
                            Tally tally;
                            const record::RunPlan plan = record::make_plan(seed);
                            record::Trial(plan, tally).run();
                            return tally.to_json();
                          }));
  }
  /// Waits for the oldest run.
  void finish_one() {
    const auto [seed, run] = std::move(running_.front());
    running_.erase(running_.begin());
    try {
      tally_.add(run->result());
    } catch (const std::exception& error) {
      if (!apps::stop_requested()) tally_.find("runs that failed", seed, error.what());
    }
    ++finished_;
  }
  [[nodiscard]] std::size_t running() const noexcept { return running_.size(); }
  [[nodiscard]] std::uint64_t finished() const noexcept { return finished_; }
  [[nodiscard]] const Tally& tally() const noexcept { return tally_; }

 private:
  std::vector<std::pair<std::uint64_t, std::unique_ptr<apps::Child>>> running_;
  std::uint64_t finished_ = 0;
  Tally tally_;
};

}  // namespace

Result run_recorders(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  const Time end = begin + from_seconds(options.seconds);
  Runs runs;
  const std::size_t most = std::max(std::thread::hardware_concurrency(), 1U) + 1;
  std::uint64_t started = 0;
  const auto wants_more = [&] {
    return options.runs > 0 ? started < options.runs : clock.now() < end;
  };
  while (wants_more() && !apps::stop_requested()) {
    runs.start(options.seed + started++);
    if (runs.running() >= most) runs.finish_one();
  }
  while (runs.running() > 0) runs.finish_one();
  return make_result(
      options, {5},
      "record: the program record beside streams that come, go, are created again, follow a law, "
      "are replaced and stopped, and send faster than it reads, while it is paused, interrupted "
      "and killed, and its disk is slow or full; from its files alone, each item is recorded or "
      "lost, as many as their senders have sent",
      std::max<std::uint64_t>(runs.finished(), 1), "runs", runs.tally().found(),
      runs.tally().work(), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
