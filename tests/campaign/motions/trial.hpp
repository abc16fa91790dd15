#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/campaign/motions/motion.hpp"
#include "tests/campaign/motions/schedule.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::campaign {

/// Results of one schedule: samples of a 1 kHz reader and counters of the waypoints.
struct Seen {
  std::vector<double> errors;              ///< rad, largest of all joints at each sample; sorted
  std::vector<double> peak_velocities;     ///< of each joint
  std::vector<double> peak_accelerations;  ///< of each joint
  double entry_acceleration = 0;           ///< rad/s², the largest in entries
  double holding = 0;                      ///< share of the samples outside pauses and deaths
  std::uint64_t refused = 0;               ///< without those that came too late
  std::uint64_t past = 0;                  ///< refused because they came too late
  std::uint64_t knots = 0;
  std::uint64_t passed_over = 0;
  std::uint64_t passed_at_start = 0;
  std::uint64_t starvations = 0;

  [[nodiscard]] double error(double share) const {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  }
  [[nodiscard]] double peak_velocity() const;
  [[nodiscard]] double peak_acceleration() const;
};

/// A sample of a 1 kHz reader. `state` is valid only during the call of TrialOptions::watch.
struct Sight {
  double t = 0;
  SampleStatus status{};
  SegmentKind kind{};             ///< of the segment at this time
  std::uint64_t starvations = 0;  ///< count up to this sample
  const State* state = nullptr;
};

/// Options of a trial.
struct TrialOptions {
  core::WindowOptions window{};  ///< the trial sets the start of a live stream
  Beyond beyond{};
  double noise = 0;        ///< rad: standard deviation of the noise added to waypoints
  double quantum = 0;      ///< rad: waypoints are rounded to multiples of it; 0: not rounded
  std::uint64_t seed = 1;  ///< of the noise
  std::function<void(const Sight&)> watch{};  ///< called with each sample that has values
};

/// A live stream in plain memory and simulated time, with the real ring, solver, board and sampler,
/// and a reader at 1 kHz.
class Trial {
 public:
  /// `motion` and `schedule` outlive the trial.
  Trial(const Motion& motion, const Schedule& schedule, TrialOptions options);

  /// Runs from kLead before the motion to its end.
  Seen run();

  /// Advances by 1 ms: the producer's calls, the solver's steps and one sample.
  void tick();
  [[nodiscard]] double now() const noexcept { return now_; }
  [[nodiscard]] const ipc::Summary& summary() const noexcept { return stream_.solver.summary(); }
  [[nodiscard]] ipc::Sampler& sampler() noexcept { return sampler_; }
  [[nodiscard]] static Time stream_time(double t);

 private:
  void produce();
  void send(const Call& call);
  void count(AppendStatus status);
  void solve();
  void read();
  [[nodiscard]] SegmentKind kind();
  void finish();

  const Motion& motion_;
  const Schedule& schedule_;
  TrialOptions options_;
  std::mt19937_64 random_;
  testing::MemoryStream stream_;
  ipc::Sampler sampler_;
  ipc::BoardSnapshot snapshot_;
  State state_;
  Seen seen_;
  int ms_;
  double now_ = 0;
  std::size_t next_ = 0;
  std::size_t death_ = 0;
  bool is_finished_ = false;
  std::uint64_t refused_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t held_ = 0;
};

}  // namespace splinecast::campaign
