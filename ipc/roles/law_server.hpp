#pragma once

#include <optional>
#include <string>

#include "core/laws/ramp.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/law/commands.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/owned/ring.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// The producer of a time law: turns the commands of the law's commanders into items of the law's
/// ring. The process that solves the law runs it.
///
/// A law is a live stream of one dimension, stream time in seconds since the law's origin, solved
/// with the method `quintic`. A change of the rate replaces what is not settled by a ramp, one or
/// two waypoints, and by a waypoint decades later at the same rate: the segment to it is the
/// straight line on which the law continues without any process. A change that the solver refuses,
/// because it was delayed, is repeated in the next step. One thread uses it.
class LawServer {
 public:
  /// Whether there is a law of this name to be produced: a commander has a ring, and no other
  /// process is the law's producer. System calls.
  [[nodiscard]] static bool is_wanted(const std::string& law);

  /// Becomes the producer of the law: continues its ring or creates one, whose origin is the
  /// present. Throws as the constructor of Producer does.
  LawServer(const std::string& law, const SolverOptions& options);

  /// The options with which the law's board is solved: those of `options` that laws have.
  [[nodiscard]] static SolverOptions solver_options(const SolverOptions& options);

  /// Begins to use the law's board, with this header. It outlives this object.
  void attach(const KnotBoardReader& board, const RegionHeader& header);

  /// Appends the items that the commands require now. `clock` is the host's. Looks for new
  /// commanders every 20 ms, with system calls.
  void step(const Clock& clock);

  /// When step() must be called even if no commander gives a command.
  [[nodiscard]] Time due() const noexcept;

  [[nodiscard]] const Commanders& commanders() const noexcept { return commanders_; }

 private:
  [[nodiscard]] WaypointRingWriter::Solved solved() const noexcept;
  void begin(const Clock& clock);
  /// The rate at which the published law ends; nothing if it has not begun. What is compared with
  /// the commands is what was committed: the solver may have refused the items in the ring.
  [[nodiscard]] std::optional<double> rate_in_force() noexcept;
  [[nodiscard]] std::optional<core::LawState> state_at(Time time) noexcept;
  void change(const Demand& demand, Time now);

  OwnerLock lock_;
  OwnedRing ring_;
  Commanders commanders_;
  const KnotBoardReader* board_ = nullptr;
  std::optional<Sampler> sampler_;
  Time freeze_ahead_{};
  Time next_look_ = Time::min();
  State state_{1};
  KnotCopy newest_{1, false};  ///< scratch
};

}  // namespace splinecast::ipc
