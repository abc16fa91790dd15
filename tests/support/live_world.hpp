#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "splinecast/ipc/settled_segments.hpp"
#include "splinecast/ipc/stream_solver.hpp"
#include "splinecast/ipc/verification.hpp"
#include "support/curve_watch.hpp"
#include "support/item_record.hpp"
#include "support/memory_stream.hpp"
#include "support/motion.hpp"
#include "support/simulated_clock.hpp"

namespace splinecast::testing {

/// What happens in a world, per second of its time. Instants are random.
struct WorldOptions {
  std::uint64_t seed = 1;
  std::size_t dimensions = 7;
  core::WindowOptions window{};
  bool starts_in_motion = false;
  double starvations = 0;
  double replacements = 0;
  double solver_kills = 0;
  double producer_kills = 0;
  double pauses = 0;  ///< of the solver, 1 to 200 ms, between steps or within one
  std::size_t max_lead_knots = 20;
  bool has_limits = true;  ///< acceleration limits of 10 times the motion's own
};

/// A producer at 100 Hz with jitter, a solver and a controller at 1 kHz on one simulated clock: the
/// real ring, board, solver and sampler in plain memory. Everything is checked as it happens; what
/// is wrong fails the test.
class LiveWorld {
 public:
  explicit LiveWorld(const WorldOptions& options);

  /// Lets it go on for so long.
  void run(core::Time duration);

  /// Sends replacements that come too late or lie ahead while the solver is stopped, then a stop,
  /// and expects that the next step brings the curve to rest from settled_until on.
  void stop_behind_misses();

  /// Finishes the stream, lets it come to rest and checks that it ends at its last waypoint.
  void finish();

  /// Solves all that has settled again.
  [[nodiscard]] ipc::Verification verify() const;

  [[nodiscard]] const apps::WatchReport& report() const { return watch_.report(); }
  [[nodiscard]] const ipc::Head& head() const { return stream_.solver.head(); }
  /// Items that the ring has accepted.
  [[nodiscard]] ipc::Word items() const { return stream_.ring.writer.head(); }
  /// Peak of the motion's own acceleration.
  [[nodiscard]] double ideal_peak() const;

  std::uint64_t sent = 0;          ///< waypoints that the ring accepted
  std::uint64_t interpolated = 0;  ///< of these, found on the curve at their time
  std::uint64_t passed_over = 0;   ///< of these, at times at which the curve is beside its target
  std::uint64_t starved = 0, replaced = 0, solver_kills = 0, producer_kills = 0, pauses = 0;
  std::uint64_t stops = 0;

 private:
  void advance_to(core::Time t);
  void tick();
  void produce();
  void replace();
  ipc::AppendStatus replace_from(core::Time t, std::size_t count);
  void send(core::Time t, std::vector<double> x);
  void run_quietly(core::Time duration);
  void expect_passed();
  [[nodiscard]] bool is_on_target(core::Time t);
  void step_solver();
  void check_settled();
  void note_items();
  void kill_solver();
  [[nodiscard]] bool happens(double per_second, core::Time within);
  [[nodiscard]] core::Time between(std::int64_t low_us, std::int64_t high_us);

  WorldOptions options_;
  std::mt19937_64 random_;
  Motion motion_;
  SimulatedClock clock_;
  MemoryStream stream_;
  ipc::Sampler sampler_;
  apps::CurveWatch watch_;
  ItemRecord items_;
  ipc::SettledSegments collected_;
  core::Time now_{};
  core::Time next_tick_{};
  core::Time next_waypoint_{};  ///< time of the next waypoint
  core::Time lead_{};           ///< how long before its time it is sent
  core::Time silent_until_{};
  struct Sent {
    core::Time time{};
    ipc::Word item = 0;
    std::vector<double> position;
  };
  std::deque<Sent> on_the_way_;  ///< accepted waypoints whose time has not come
  std::map<ipc::Word, std::vector<double>>
      settled_;  ///< coefficients of settled segments by number
};

}  // namespace splinecast::testing
