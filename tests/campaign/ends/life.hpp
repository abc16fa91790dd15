#pragma once

#include <optional>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/campaign/ends/curve_watch.hpp"

namespace splinecast::campaign::ends {

/// The clock of a life: stream time, which passes at the rate of a law or is held by it.
class LifeClock final : public Clock {
 public:
  explicit LifeClock(const LifePlan& plan)
      : rate_(plan.rate), stream_(plan.stream.begin), host_(plan.stream.begin) {}

  [[nodiscard]] Time now() const noexcept override { return stream_; }
  [[nodiscard]] Time host_time(Time /*now*/) const noexcept override { return host_; }
  [[nodiscard]] Time latest(Time now, Time ahead) const noexcept override {
    return is_held_ ? now : now + stream_length(ahead);
  }
  [[nodiscard]] std::optional<Time> held() const noexcept override {
    return is_held_ ? std::optional(stream_) : std::nullopt;
  }

  [[nodiscard]] Time host() const noexcept { return host_; }
  /// The stream time that passes in a time of the host.
  [[nodiscard]] Time stream_length(Time host) const noexcept {
    return Time(static_cast<std::int64_t>(static_cast<double>(host.count()) * rate_));
  }
  void hold(bool is_held) noexcept { is_held_ = is_held; }
  /// Advances the host's clock.
  void pass(Time host) noexcept {
    host_ += host;
    if (!is_held_) stream_ += stream_length(host);
  }

 private:
  double rate_;
  Time stream_;
  Time host_;
  bool is_held_ = false;
};

/// A live stream in plain memory and simulated time, with the real ring, solver, board and sampler,
/// from its first waypoint until it rests.
class Life {
 public:
  Life(const LifePlan& plan, Tally& tally, Random& random);
  Life(const Life&) = delete;
  Life& operator=(const Life&) = delete;

  void run();

 private:
  void hold_or_release();
  void act();
  void send_waypoints();
  void begin_end();
  void replace_motion();
  void finish();
  void step();
  void replace_solver();
  void step_and_die();
  void sample();
  void sample_after_end();
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] ipc::WaypointRingWriter::Solved solved() const;
  [[nodiscard]] Waypoint waypoint(std::size_t i) const;

  const LifePlan& plan_;
  Tally& tally_;
  Random& random_;
  LifeClock clock_;
  testing::MemoryStream stream_;
  CurveWatch watch_;
  ipc::Sampler sampler_;
  State state_;
  std::size_t sent_ = 0;  ///< waypoints sent
  Time end_at_;           ///< stream time of the next action of the end; max(): none
  bool is_ending_ = false;
  bool has_asked_ = false;  ///< the finish is in the ring
  bool is_held_ = false;
  bool was_held_ = false;
  Time released_at_{};  ///< host time
  Time asked_at_{};     ///< host time of the finish
  int steps_after_finish_ = 0;
  int steps_without_finish_ = 0;  ///< after the last action
};

}  // namespace splinecast::campaign::ends
