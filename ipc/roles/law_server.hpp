#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/law/commanded_rate.hpp"
#include "ipc/law/commander_faults.hpp"
#include "ipc/law/commands.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/region_watch.hpp"
#include "ipc/owned/ring.hpp"
#include "ipc/requests/faults.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/law_planner.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// The producer of a time law: turns the commands of the law's commanders into items of the law's
/// ring. The process that solves the law runs it.
///
/// A law is a live stream of one dimension, stream time in seconds since the law's origin, solved
/// with the method `quintic`. A change of the rate replaces what is not settled by up to three
/// pieces, and by a straight line of decades, on which the law continues without any process: see
/// core::LawPath. It is planned in the solver's step; a plan whose revision is discarded, because
/// the process was delayed, is withdrawn and planned again in the next step. One thread uses it.
class LawServer : public LawPlanner {
 public:
  /// Whether there is a law of this name to be produced: a commander has a region, and no other
  /// process is the law's producer. System calls if there is a commander.
  [[nodiscard]] static bool is_wanted(const std::string& law, const RegionWatch& watch);

  /// Becomes the producer of the law: continues its ring or creates one, whose origin is the
  /// present. `watch` outlives this object; its owner calls its poll() before each step. Throws as
  /// the constructor of Producer does.
  LawServer(const std::string& law, const SolverOptions& options, const RegionWatch& watch);

  /// The options with which the law's board is solved: those of `options` that laws have.
  [[nodiscard]] static SolverOptions solver_options(const SolverOptions& options);

  /// Begins to use the law's board, with this header. It outlives this object.
  void attach(const KnotBoardReader& board, const RegionHeader& header);

  /// Opens new commanders' regions when the watch knows them, and looks every 20 ms for those that
  /// are gone or cannot be used, with system calls. Call it before the solver's step. `clock` is
  /// the host's.
  void poll(const Clock& clock);

  /// Appends the items that the commands require now: see LawPlanner. Requires attach().
  LawPlan plan(Time now, Time settled) noexcept override;

  /// When a step is needed even if no commander gives a command.
  [[nodiscard]] Time due() const noexcept;

  [[nodiscard]] const Commanders& commanders() const noexcept { return commanders_; }

  /// See faults_of() and RequestFaults::take().
  void take_faults(std::vector<std::string>& out) { faults_.take(out); }

 private:
  [[nodiscard]] WaypointRingWriter::Solved solved() const noexcept;
  [[nodiscard]] LawPlan begin(Time now, Time settled) noexcept;
  void take_over(const core::LawState& state) noexcept;
  /// Copies the newest knot of the published law: the end of its straight line. Returns false if
  /// the law has not begun.
  [[nodiscard]] bool read_newest() noexcept;
  [[nodiscard]] core::RateCurve published(const core::LawState& from) noexcept;
  [[nodiscard]] std::optional<core::LawState> state_at(Time time) noexcept;
  void judge_sent() noexcept;

  OwnerLock lock_;
  OwnedRing ring_;
  Commanders commanders_;
  RequestFaults faults_;
  const KnotBoardReader* board_ = nullptr;
  std::optional<Sampler> sampler_;
  Time freeze_ahead_{};
  Time next_poll_ = Time::min();
  State state_{1};
  CommandedRate rate_;
  bool is_rate_known_ = false;  ///< rate_ is that of the board, with the line that ends there:
  Time line_end_{};
  std::optional<Word> planned_at_;  ///< newest revision when the last plan was made
  std::optional<Time> sent_;        ///< end of the line of that plan, if it changes the curve
  Summary summary_;                 ///< scratch, with the next two
  KnotCopy newest_{1, false};
  KnotCopy knot_{1, false};
};

}  // namespace splinecast::ipc
