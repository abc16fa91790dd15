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

/// Synchronizes the processes of a measurement.
struct Meeting {
  std::atomic<std::size_t> ready{0};        ///< processes that have attached
  std::atomic<std::int64_t> start_ns{0};    ///< of the schedule; 0 until it is known
  std::atomic<ipc::Word> last_revision{0};  ///< last one of the stream; 0 until it is known

  /// Counts this process as ready, and sleeps until the producer has set the start time. Returns
  /// false after kLatencyPatience, or if a stop is requested.
  [[nodiscard]] bool await_start();
  /// Waits for `count` processes and starts the schedule 20 ms later. Throws TimeOut, or
  /// Interrupted if a stop is requested.
  [[nodiscard]] Time begin(std::size_t count);
};

/// The memory that the processes of the pipeline share, mapped before they are forked.
struct LatencyShared {
  explicit LatencyShared(const LatencyOptions& options);

  Shared<Meeting> meeting;
  SharedLog<AppendStamp> appends;
  SharedLog<RevisionStamp> revisions;
  SharedLog<ipc::Word> refused;            ///< items that the solver refused
  std::vector<SharedLog<SeenStamp>> seen;  ///< per reader
};

/// The size of LatencyShared in bytes, all of which are touched.
[[nodiscard]] double bytes_noted(const LatencyOptions& options);

/// The kernel's counts over the measured time.
class MeasuredUsage {
 public:
  MeasuredUsage(const Meeting& meeting, Time warmup) : meeting_(&meeting), warmup_(warmup) {}

  /// Begins to count at the first call after the warm-up.
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

/// Waits for an instant, spinning or asleep. Returns false if a stop is requested.
[[nodiscard]] bool wait_for_instant(Time instant, bool spin);

/// The three roles, each in its own process; with options.embedded the producer also solves. Each
/// writes its stamps to `shared` and returns `role`, `warnings`, `usage` and its own counters. They
/// end when the producer has completed the schedule, or a stop is requested. Throw TimeOut if
/// another process does not start, and Failure if a log is full.
[[nodiscard]] nlohmann::json run_latency_producer(const LatencyOptions& options,
                                                  const std::string& stream, LatencyShared& shared);
[[nodiscard]] nlohmann::json run_latency_solver(const LatencyOptions& options,
                                                const std::string& stream, LatencyShared& shared);
[[nodiscard]] nlohmann::json run_latency_reader(const LatencyOptions& options,
                                                const std::string& stream, LatencyShared& shared,
                                                std::size_t index);

}  // namespace splinecast::apps
