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

/// Memory that the processes of a row share with the one that started them; it outlives them.
struct LiveFacts {
  std::atomic<std::uint64_t> calls;          ///< completed calls of the schedule
  std::atomic<std::int64_t> producer_late;   ///< ns, largest delay of a call after its time
  std::atomic<std::int64_t> solver_late;     ///< ns, largest delay of a step after `due`
  std::atomic<std::uint64_t> late_calls;     ///< calls that returned `past` or `too late`
  std::atomic<std::uint64_t> refused_calls;  ///< calls refused for other reasons
};

/// Results of a row: those of Seen, and delays that the machine caused.
struct LiveSeen {
  double peak_velocity = 0;
  double peak_acceleration = 0;
  double error_p99 = 0;      ///< rad, from 2 s on
  double largest_error = 0;  ///< rad, from 2 s on
  double holding = 0;        ///< share of the samples outside pauses and deaths
  std::uint64_t samples = 0;
  std::uint64_t steps = 0;    ///< steps of the position from sample to sample
  std::uint64_t revised = 0;  ///< samples with the status `revised`
  std::uint64_t refused = 0;  ///< without those that came too late
  std::uint64_t came_late = 0;
  std::uint64_t passed_over = 0;
  std::uint64_t passed_at_start = 0;
  std::uint64_t knots = 0;
  std::uint64_t late_commits = 0;
  std::uint64_t deadline_misses = 0;
  std::uint64_t kills = 0;
  double producer_late = 0;  ///< s, see LiveFacts
  double solver_late = 0;    ///< s, see LiveFacts
};

/// A fault with real processes over real shared memory, in real time: a producer, a solver and a
/// reader at 1 kHz. If the schedule has deaths, SIGKILL ends the solver at its deaths and the
/// producer in its pauses.
class LiveRow {
 public:
  static constexpr double kSeconds = 10;  ///< of the motion

  /// Starts the processes. The motion begins at `begin` on CLOCK_MONOTONIC. `limit` is in rad/s²;
  /// 0: none. The arguments outlive the row.
  LiveRow(const Sines& motion, const Fault& fault, double limit, Time begin, std::string stream);
  LiveRow(const LiveRow&) = delete;
  LiveRow& operator=(const LiveRow&) = delete;
  /// Kills the remaining processes and removes the stream.
  ~LiveRow();

  [[nodiscard]] const Fault& fault() const noexcept { return fault_; }
  [[nodiscard]] double limit() const noexcept { return limit_; }

  /// Kills and starts processes by the schedule. Call it every few ms until the end of the motion.
  void tick(Time now);

  /// Waits until the reader has read to the end. Returns its results.
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
  const Fault& fault_;
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
  ipc::Summary summary_;
  std::uint64_t passed_at_start_ = 0;
  std::uint64_t kills_ = 0;
};

}  // namespace splinecast::campaign
