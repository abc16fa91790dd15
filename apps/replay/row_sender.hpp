#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "apps/recordings/late_rows.hpp"
#include "apps/recordings/recording.hpp"
#include "apps/replay/embedded_solver.hpp"
#include "apps/replay/player.hpp"
#include "apps/replay/sent_rows.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {

/// Appends the waypoints of a replay to the ring, each at its time, and waits for room.
class RowSender {
 public:
  RowSender(const ReplayOptions& options, EmbeddedSolver& solver, Producer& producer,
            SentRows& rows, bool has_gaps)
      : options_(options), solver_(solver), producer_(producer), rows_(rows), has_gaps_(has_gaps) {}

  /// Sets the lead of a live stream. Call it before send().
  void set_lead(Time lead) noexcept { lead_ = lead; }
  [[nodiscard]] Time lead() const noexcept { return lead_; }

  /// Sends a row whose time, without shifts, is on the stream's clock. After a gap, lets the motion
  /// stop first. Returns false if a stop is requested.
  bool send(const PlayedRow& row, Waypoint waypoint, bool follows_gap);

  /// Stops the motion of a live stream as soon as possible. Reports if the ring stays full for 1 s.
  void stop_at_once();

  /// Waits while the solver has work to do; false if a stop is requested. Waits for a live solver
  /// without limit, for a new one at most --wait; then throws TimeOut.
  bool await_room();
  bool await_consumption();

  /// Rows that were late when they could be sent.
  [[nodiscard]] const LateRows& late() const noexcept { return late_; }

 private:
  bool pace(Time waypoint_time);
  bool wait_for_stream_time(Time instant);
  bool stop_at_gap(const Waypoint& next);
  [[nodiscard]] Time entry_begin(const Waypoint& next) const;
  void note_last(const Waypoint& waypoint);
  AppendStatus append_when_there_is_room(Waypoint& waypoint);
  Time shift_if_late(Waypoint& waypoint);
  void note_lateness(Time lateness, Time moved_by);
  AppendStatus append(const Waypoint& waypoint);
  AppendStatus replace(Time t, std::span<const Waypoint> waypoints);
  [[nodiscard]] bool is_late() const;
  bool await(const std::function<bool()>& wait);

  const ReplayOptions& options_;
  EmbeddedSolver& solver_;
  Producer& producer_;
  SentRows& rows_;
  const bool has_gaps_;  ///< else nothing is noted about the motion so far
  MonotonicClock clock_;
  Time recorded_start_{};
  Time lead_{};
  LateRows late_;
  std::optional<Time> last_time_{};    ///< of the last waypoint in the ring
  std::vector<double> last_{};         ///< its position
  std::vector<double> fastest_{};      ///< largest velocity between waypoints, for each dimension
  std::optional<Time> entry_begin_{};  ///< where the motion begins again, for the next waypoint
};

}  // namespace splinecast::apps
