#pragma once

#include <atomic>
#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "apps/process/child.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "tests/campaign/motions/schedule.hpp"
#include "tests/campaign/motions/sines.hpp"

namespace splinecast::campaign {

/// What the processes of a row tell the one that started them, in memory that outlives them.
struct LiveFacts {
  std::atomic<std::uint64_t> calls;          ///< of the schedule that have been made
  std::atomic<std::int64_t> producer_late;   ///< ns, largest: a call behind its time
  std::atomic<std::int64_t> solver_late;     ///< ns, largest: a step behind `due`
  std::atomic<std::uint64_t> late_calls;     ///< answered `past` or `too late`
  std::atomic<std::uint64_t> refused_calls;  ///< refused for other reasons
};

/// What a row showed: as in Seen, and what the machine did to it.
struct LiveSeen {
  double peak_velocity = 0;
  double peak_acceleration = 0;
  double error_p99 = 0;      ///< rad, from 2 s on
  double largest_error = 0;  ///< rad, likewise
  double holding = 0;        ///< share of the samples, but those in pauses
  std::uint64_t samples = 0;
  std::uint64_t steps = 0;    ///< of the position, from sample to sample
  std::uint64_t revised = 0;  ///< samples: the curve was changed behind the reader
  std::uint64_t refused = 0;  ///< but those that came too late
  std::uint64_t came_late = 0;
  std::uint64_t passed_over = 0;
  std::uint64_t passed_at_start = 0;
  std::uint64_t knots = 0;
  std::uint64_t late_commits = 0;
  std::uint64_t misses = 0;
  std::uint64_t kills = 0;
  double producer_late = 0;  ///< s, as in LiveFacts
  double solver_late = 0;    ///< s
};

/// A mishap with real processes over real shared memory, in real time: a producer, a solver and a
/// reader at 1 kHz. A schedule with deaths has them die by SIGKILL, the producer in its pauses.
class LiveRow {
 public:
  static constexpr double kSeconds = 10;  ///< of the motion

  /// Starts the processes. The motion begins at `begin` on CLOCK_MONOTONIC. `limit` in rad/s², 0:
  /// none. The arguments outlive it.
  LiveRow(const Sines& motion, const Mishap& mishap, double limit, Time begin, std::string stream);
  LiveRow(const LiveRow&) = delete;
  LiveRow& operator=(const LiveRow&) = delete;
  /// Kills what still runs and removes the stream.
  ~LiveRow();

  [[nodiscard]] const Mishap& mishap() const noexcept { return mishap_; }
  [[nodiscard]] double limit() const noexcept { return limit_; }

  /// Kills and starts who is to be. To be called every few ms, until the motion has ended.
  void tick(Time now);

  /// Ends all processes once the reader has read to the end. Returns what it saw.
  [[nodiscard]] LiveSeen finish();

 private:
  void start_solver();
  void start_producer();
  void start_reader();
  void run_solver() const;
  void run_producer() const;
  [[nodiscard]] nlohmann::json run_reader() const;
  void send(Producer& producer, const Call& call) const;
  void count(AppendStatus status) const;
  [[nodiscard]] Time stream_time(double t) const;

  const Sines& motion_;
  const Mishap& mishap_;
  double limit_;
  Time begin_;
  std::string stream_;
  Schedule schedule_;
  boost::interprocess::mapped_region memory_;
  LiveFacts* facts_;
  std::optional<apps::Child> solver_;
  std::optional<apps::Child> producer_;
  std::optional<apps::Child> reader_;
  std::optional<Reader> observer_;
  ipc::Head head_;
  std::uint64_t passed_at_start_ = 0;
  std::uint64_t kills_ = 0;
};

}  // namespace splinecast::campaign
