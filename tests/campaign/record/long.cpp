#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <list>
#include <string>
#include <vector>

#include "apps/process/descriptors.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/record/program.hpp"
#include "tests/campaign/record/source.hpp"

namespace splinecast::campaign {
namespace {

using record::Program;

/// Streams that exist at the same time.
constexpr std::uint64_t kAtOnce = 100;
constexpr Time kInterval = std::chrono::milliseconds(10);
constexpr std::uint64_t kParts = 10;

/// A stream that is created, sent, finished and removed.
class ShortStream {
 public:
  explicit ShortStream(const std::string& name)
      : name_(name),
        producer_(std::in_place, name, ProducerOptions{.clock = StreamClock::recorded}),
        solver_(std::in_place, name, SolverOptions{}) {
    (void)solver_->attach(clock_);
  }
  void send(std::uint64_t items) {
    for (std::uint64_t i = 0; i + 1 < items; ++i) {
      const Time time = kInterval * static_cast<std::int64_t>(i);
      const std::array position{record::position_at(time, 0, false)};
      while (producer_->append({.time = time, .position = position}) == AppendStatus::full) step();
    }
    (void)producer_->finish();
    step();
  }
  /// Returns the number of items sent.
  std::uint64_t remove() {
    const std::uint64_t sent = producer_->appended();
    producer_.reset();
    solver_.reset();
    remove_stream(name_);
    return sent;
  }

 private:
  void step() {
    while (solver_->step(clock_).consumed > 0) {
    }
  }

  std::string name_;
  MonotonicClock clock_;
  std::optional<Producer> producer_;
  std::optional<Solver> solver_;
};

/// A recorder of many names, one group after the other.
class LongRecording {
 public:
  explicit LongRecording(const CampaignOptions& options)
      : options_(options),
        prefix_(campaign_stream("record")),
        recorder_({"record", prefix_ + ".*", "-o", folder_.path("run.mcap"), "--json", "--max-size",
                   "256MiB", "--max-files", "4"},
                  folder_.path("recorder")) {
    if (!recorder_.await_message("recording to")) throw apps::Failure(recorder_.err());
  }

  void run() {
    note();
    while (names_ < options_.names && !apps::stop_requested()) {
      run_group(std::min(kAtOnce, options_.names - names_));
      if (names_ * kParts >= options_.names * (parts_ + 1)) note();
    }
    recorder_.signal(SIGINT);
    code_ = recorder_.wait();
    report_ = nlohmann::json::parse(recorder_.out());
  }
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
  [[nodiscard]] nlohmann::json found() const {
    const std::uint64_t there =
        report_["items"].get<std::uint64_t>() + report_["lost_items"].get<std::uint64_t>();
    return {{"items neither recorded nor lost", std::max(sent_, there) - std::min(sent_, there)},
            {"wrong exit codes", code_ == (report_["lost"] > 0 ? 5 : 0) ? 0 : 1}};
  }
  [[nodiscard]] nlohmann::json measured() const {
    nlohmann::json all = memory_;
    all["names"] = names_;
    all["items lost"] = report_["lost_items"];
    all["files"] = report_["files"].size();
    return all;
  }

 private:
  void run_group(std::uint64_t count) {
    std::list<ShortStream> streams;
    for (std::uint64_t i = 0; i < count; ++i) {
      streams.emplace_back(fmt::format("{}.{}", prefix_, names_++));
    }
    // It finds all streams that exist when it finds the newest one.
    const std::string newest = fmt::format("'{}.{}': recording", prefix_, names_ - 1);
    if (!recorder_.await_message(newest)) throw apps::Failure(recorder_.err());
    for (ShortStream& stream : streams) stream.send(options_.items / options_.names);
    for (ShortStream& stream : streams) sent_ += stream.remove();
  }
  void note() {
    parts_ = names_ * kParts / options_.names;
    const double mebibytes = static_cast<double>(recorder_.memory()) / 1024;
    memory_[fmt::format("memory after {} % of the names [MiB]", parts_ * 100 / kParts)] = mebibytes;
    apps::say(
        fmt::format("{} names, {} items: the recorder takes {:.1f} MiB", names_, sent_, mebibytes));
  }

  const CampaignOptions& options_;
  std::string prefix_;
  record::Folder folder_;
  Program recorder_;
  std::uint64_t names_ = 0;  ///< that there have been
  std::uint64_t sent_ = 0;
  std::uint64_t parts_ = 0;
  nlohmann::json memory_ = nlohmann::json::object();
  nlohmann::json report_;
  std::optional<int> code_;
};

}  // namespace

Result run_long_recording(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  apps::raise_descriptor_limit();
  LongRecording recording(options);
  recording.run();
  return make_result(options, {5},
                     "long recording: one recorder of many names that come and go, 100 at a time; "
                     "the items recorded and lost are those sent",
                     std::max<std::uint64_t>(recording.sent(), 1), "items", recording.found(),
                     recording.measured(), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
