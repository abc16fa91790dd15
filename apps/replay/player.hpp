#pragma once

#include <array>
#include <optional>
#include <string>

#include "apps/recordings/late_rows.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/tables/waypoints.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/options.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::apps {

/// What `replay` is told.
struct ReplayOptions {
  std::string file{};
  TableOptions table{};
  std::string stream{};
  std::optional<double> rate = 1.0;  ///< unset: as fast as it goes
  std::size_t loops = 1;
  std::optional<Time> from{};
  std::optional<Time> duration{};
  StreamClock clock = StreamClock::monotonic;
  std::optional<Time> lead{};  ///< unset: what the recording and the settle lag need
  std::optional<Condition> start{};
  std::optional<Condition> end{};
  LatePolicy late = LatePolicy::refuse;
  bool skip_bad = false;
  Time wait{10'000'000'000};
  bool embedded = false;
  bool verify = false;  ///< solve what settles again, and compare
  bool json = false;
  bool quiet = false;
  std::size_t capacity = 1024;
  IngestLimits limits{};
  RegionAccess access{};
  Trust trust{};
  SolverOptions solver{};  ///< of the embedded solver
};

/// What became of a replay.
struct ReplayReport {
  ipc::Word sent = 0;          ///< waypoints accepted by the ring
  ipc::Word unsent = 0;        ///< not come to: the replay was stopped, or interrupted
  ipc::Word interpolated = 0;  ///< of these, by the solver
  ipc::Word passed_over = 0;   ///< of these, by entries: taken, but the curve does not meet them
  ipc::Word refused = 0;       ///< of these, by the solver, with a reason
  std::array<ipc::Word, kRefusals> refused_by_reason{};
  LateRows late{};                     ///< rows that were late when they could be sent
  std::optional<RefusedBy> stopped{};  ///< who refused the row at which --on-error stop stopped it
  bool interrupted = false;
  std::optional<ipc::Verification> verification{};  ///< if one was asked for
};

/// How a replay ends: kFellShort if what was solved again differs, else by who stopped it, else
/// kInterrupted if a signal did.
[[nodiscard]] int exit_code(const ReplayReport& report);

/// Makes a file's table what is to be sent: the rows and the rate asked for. Rows that cannot be
/// sent are noted in `refused`, or, without `skip_bad`, the first one throws InputError. Returns
/// the rows that are late in the file itself.
LateRows prepare_replay(WaypointTable& table, const ReplayOptions& options, RefusedRows& refused);

/// Sends a prepared table's waypoints to a solver and waits until all are consumed. Notes in
/// `refused` each row that the producer's append or the solver refused; without `skip_bad` the
/// first one ends the stream with what has been sent. Throws TimeOut if no solver comes.
ReplayReport replay_table(const WaypointTable& table, const ReplayOptions& options,
                          RefusedRows& refused);

}  // namespace splinecast::apps
