#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ipc/layout/summary.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/state.hpp"
#include "tests/campaign/starts/facts.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::starts {

/// The limits of each dimension.
inline constexpr double kVelocity = 3;
inline constexpr double kAcceleration = 15;
/// The controller's period, and that of the solver's steps.
inline constexpr Time kTick{1'000'000};

/// A clock that advances by up to 2 µs at each reading.
class WorldClock final : public Clock {
 public:
  explicit WorldClock(Random& random)
      : random_(random), time_((MonotonicClock().now() / kStart + 1) * kStart) {}
  [[nodiscard]] Time now() const noexcept override {
    return time_ += Time(static_cast<std::int64_t>(random_.below(2'000)));
  }
  void advance(Time by) noexcept { time_ += by; }

 private:
  /// A multiple of it: the same seed then gives the same run at any time.
  static constexpr Time kStart{10'000'000'000};

  Random& random_;
  mutable Time time_;
};

/// The machine of a stream name in simulated time, with the real regions and roles: a solver that
/// is stopped and killed, and a controller that follows what it finds, as the manual says.
class World {
 public:
  World(std::uint64_t seed, Random& random, Facts& facts);
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World();

  /// Lets time pass, at most until `done()`.
  template <typename Done>
  bool pass_until(Time most, const Done& done) {
    for (Time passed{}; passed < most; passed += kTick) {
      if (done()) return true;
      tick();
    }
    return done();
  }
  void pass(Time time) {
    (void)pass_until(time, [] { return false; });
  }

  [[nodiscard]] ProducerOptions producer_options() const;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Clock& clock() const noexcept { return clock_; }
  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  /// The position of all dimensions at the coordinate s.
  [[nodiscard]] std::vector<double> position(double s) const;
  /// The largest way in one dimension; the angle of a rotation.
  [[nodiscard]] double distance(std::span<const double> from, std::span<const double> to) const;
  /// The position of a stream's curve at t; nothing if its board does not have it.
  [[nodiscard]] std::optional<std::vector<double>> position_at(Time t, std::uint64_t stream);
  /// The position that the controller holds; empty if it has followed nothing.
  [[nodiscard]] std::span<const double> held() const noexcept { return held_; }
  /// The machine was moved to another place by hand, or by another program.
  /// Its controller then follows only the stream of this id.
  void move(std::uint64_t stream) noexcept {
    held_.clear();
    reader_.reset();
    only_ = stream;
  }

  /// Kills the solver, stops it for up to 60 ms, or does nothing.
  void disturb_solver();
  void start_solver();
  [[nodiscard]] bool has_solver() const noexcept { return solver_ && solver_->attached(); }
  /// The newest summary of the stream's board; nothing without an attached solver.
  [[nodiscard]] const ipc::Summary* summary() const noexcept;
  /// Removes the stream. No producer may live.
  void remove();

 private:
  void tick();
  void control();
  void attach();
  void compare(Time now, std::span<const double> before);
  void compare_limits();
  [[nodiscard]] std::size_t linear() const noexcept {
    return dimensions_ - (has_quaternion_ ? kQuaternionSize : 0);
  }

  std::uint64_t seed_;
  Random& random_;
  Facts& facts_;
  std::string name_;
  WorldClock clock_;
  std::size_t dimensions_;
  bool has_quaternion_;
  bool is_periodic_;
  SolverOptions how_;
  std::optional<Solver> solver_;
  Time asleep_until_{};  ///< the solver makes no step, or does not exist, before
  std::optional<Reader> reader_;
  std::optional<Reader> observer_;  ///< of any time
  State sampled_;
  std::vector<double> held_;
  Time held_at_{};
  Time attaches_at_{};  ///< no attempt to attach before
  std::optional<std::uint64_t> only_{};
  std::uint64_t counted_ = 0;  ///< excesses that the board of the reader counts
};

}  // namespace splinecast::campaign::starts
