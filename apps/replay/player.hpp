#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/cli/conditions.hpp"
#include "apps/recordings/recording.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/tables/options.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/options.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::apps {

/// Where a new live stream starts: at the end of the earlier stream of its name, at the first
/// waypoint, to which the machine was moved, or at a measured position.
struct FromOldEnd {};
struct FromFirst {};
using StartFrom = std::variant<FromOldEnd, FromFirst, std::vector<double>>;

/// Options of `replay`.
struct ReplayOptions {
  std::string file{};
  TableOptions table{};
  std::string stream{};
  std::optional<double> rate = 1.0;  ///< unset: as fast as possible
  std::size_t loops = 1;
  std::optional<Time> from{};
  std::optional<Time> duration{};
  /// Of the stream. The recording determines its dimensions, names, units and kinds, and `start`
  /// its start: these members are not read.
  ProducerOptions ring{};
  std::optional<Time> lead{};  ///< unset: what the recording and the settle lag need
  std::optional<Condition> start{};
  std::optional<StartFrom> start_from{};
  std::optional<End> end{};
  LatePolicy late = LatePolicy::refuse;
  GapOptions gap{};
  bool skip_bad = false;
  Time wait{10'000'000'000};
  bool embedded = false;
  bool verify = false;  ///< solve the settled segments again and compare
  bool json = false;
  bool quiet = false;
  SolverOptions solver{};  ///< of the embedded solver
};

/// The result of a replay.
struct ReplayReport {
  ipc::Word sent = 0;          ///< waypoints accepted by the ring
  ipc::Word unsent = 0;        ///< not reached: the replay was stopped or interrupted
  ipc::Word interpolated = 0;  ///< sent waypoints that the solver interpolated
  ipc::Word passed_over = 0;   ///< sent waypoints that entries passed over: not on the curve
  ipc::Word refused = 0;       ///< sent waypoints that the solver refused, with a reason
  std::array<ipc::Word, kRefusals> refused_by_reason{};
  LateRows late{};  ///< rows that were late when they could be sent
  Gaps gaps{};
  ipc::Summary end{};                  ///< of the curve after the replay
  std::optional<RefusedBy> stopped{};  ///< who refused the row that stopped it (--on-error stop)
  bool interrupted = false;
  std::optional<ipc::Verification> verification{};  ///< with `verify`
};

/// The exit code of a replay: kFellShort if the verification found a difference, else by who
/// refused the row that stopped it, else kInterrupted if a signal stopped it.
[[nodiscard]] int exit_code(const ReplayReport& report);

/// How the rows of a replay are prepared.
[[nodiscard]] Preparation preparation_of(const ReplayOptions& options);

/// Opens the file of the options and makes the first pass. Adds rows that cannot be sent to
/// `refused`; without `skip_bad`, throws InputError for the first one.
[[nodiscard]] Recording open_recording(const ReplayOptions& options, RefusedRows& refused);

/// Throws InputError for options that do not fit the recording: conditions of other dimensions or
/// that a stream cannot meet, and loops that take too long.
void require_playable(const Recording& recording, const ReplayOptions& options);

/// Sends the waypoints of a recording to a solver and waits until all are consumed. Notes in
/// `refused` each row that the producer's append or the solver refused; without `skip_bad` the
/// first one ends the stream after the rows sent so far. Throws TimeOut if no solver attaches, and
/// InputError, after it has ended the stream, if the file can no longer be read or has changed.
ReplayReport replay_recording(Recording& recording, const ReplayOptions& options,
                              RefusedRows& refused);

}  // namespace splinecast::apps
