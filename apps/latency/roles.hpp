#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/latency/options.hpp"
#include "apps/latency/stamps.hpp"
#include "apps/process/settings.hpp"
#include "apps/process/shared_log.hpp"

namespace splinecast::apps {

/// How long a process of `latency` waits for another one.
inline constexpr Time kLatencyPatience = std::chrono::seconds(10);

/// Where the processes of a measurement meet.
struct Meeting {
  std::atomic<std::size_t> ready{0};        ///< processes that have attached
  std::atomic<std::int64_t> start_ns{0};    ///< of the schedule; 0 until it is known
  std::atomic<ipc::Word> last_revision{0};  ///< after which nothing comes; 0 until it is known

  /// Counts this process as ready, and waits until the producer has said when it starts: for a
  /// process that has nothing else to do. Returns false if that does not come.
  [[nodiscard]] bool await_start();
  /// Waits for `count` processes and starts the schedule a little later. Throws TimeOut.
  [[nodiscard]] Time begin(std::size_t count);
};

/// What the processes of the pipeline share, mapped before they are forked.
struct LatencyShared {
  explicit LatencyShared(const LatencyOptions& options);

  Shared<Meeting> meeting;
  SharedLog<AppendStamp> appends;
  SharedLog<RevisionStamp> revisions;
  SharedLog<ipc::Word> refused;            ///< items that the solver refused
  std::vector<SharedLog<SeenStamp>> seen;  ///< per reader
};

/// How many bytes LatencyShared takes, all of which are touched.
[[nodiscard]] double bytes_noted(const LatencyOptions& options);

/// Counts of the kernel over the time that is measured.
class MeasuredUsage {
 public:
  MeasuredUsage(const Meeting& meeting, Time warmup) : meeting_(&meeting), warmup_(warmup) {}

  /// Begins to count once the warm-up is over.
  void look(Time now) {
    const Time start(meeting_->start_ns.load(std::memory_order_relaxed));
    if (begun_ || start == Time::zero() || now < start + warmup_) return;
    begun_ = true;
    before_ = usage_now();
  }
  [[nodiscard]] nlohmann::ordered_json json() const {
    const Usage after = usage_now();
    return to_json(begun_ ? before_ : after, after);
  }

 private:
  const Meeting* meeting_;
  Time warmup_;
  bool begun_ = false;
  Usage before_;
};

/// Waits for an instant as the mode says: spinning or asleep. Returns false if a stop is requested.
[[nodiscard]] bool wait_for_instant(Time instant, bool spin);

/// The three roles, each in a process of its own; with options.embedded the producer also solves.
/// What they note goes to `shared`; each returns `role`, `warnings`, `usage` and its own counters.
/// They end when the producer has carried the schedule out, or a stop is requested. Throw Failure
/// or TimeOut if another process does not come or the logs are too small.
[[nodiscard]] nlohmann::json run_latency_producer(const LatencyOptions& options,
                                                  const std::string& stream, LatencyShared& shared);
[[nodiscard]] nlohmann::json run_latency_solver(const LatencyOptions& options,
                                                const std::string& stream, LatencyShared& shared);
[[nodiscard]] nlohmann::json run_latency_reader(const LatencyOptions& options,
                                                const std::string& stream, LatencyShared& shared,
                                                std::size_t index);

}  // namespace splinecast::apps
