#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "apps/recordings/recording.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/replay/player.hpp"
#include "apps/streams/log.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {

/// A row of a recording, and the loop in which it is played.
struct PlayedRow {
  std::size_t number;  ///< of the row, see Row::number; 0: an item that is not a row
  std::size_t loop;    ///< from 0
};

/// The rows that a replay has sent, and who refused which. Maps an item that the solver refused to
/// its row in the file.
class SentRows {
 public:
  SentRows(const Recording& recording, const ReplayOptions& options, Producer& producer,
           RefusedRows& refused)
      : recording_(recording), options_(options), producer_(producer), refused_(refused) {}

  /// Ignores earlier refusals, of another producer. With `verify`, keeps all rows sent from now on;
  /// throws InputError if the stream already has waypoints.
  /// `require_readable` throws if refusals cannot be read.
  void begin(std::function<void()> require_readable);

  /// Notes a start state that the ring has accepted.
  void note_start(const Waypoint& state);

  /// The ring may accept a start state at rest at this position before the first row.
  void expect_start(std::span<const double> position) {
    old_end_.assign(position.begin(), position.end());
  }

  /// Notes a row that the ring has accepted.
  void note_sent(const PlayedRow& row, const Waypoint& waypoint);

  /// Notes a replacement without waypoints, or the one item before the waypoints of a replacement.
  void note_replacement(Time t);

  /// Notes a row that the append refused: it is not in the ring.
  void note_refusal(const PlayedRow& row, Time time, AppendStatus status);

  /// Notes the solver's refusals since the last call. Call it with every waypoint, because the
  /// board keeps the last refusals only. Cheap if nothing was published since.
  void look();

  /// The same, once there is a board. Before, there are no refusals.
  void look_if_begun() {
    if (has_begun_) look();
  }

  /// Throws if the board has no summary: no refusal can be read.
  void require_readable() const { require_readable_(); }

  /// Notes the last refusals, and counts those whose rows could not be named.
  void finish();

  /// Solves the sent waypoints again and compares; nullopt without `verify`.
  [[nodiscard]] std::optional<ipc::Verification> verify(const Condition& end);

  /// Rows that the ring has accepted, and that the append refused.
  [[nodiscard]] ipc::Word sent() const noexcept { return sent_; }
  [[nodiscard]] ipc::Word refused_by_producer() const noexcept { return refused_by_producer_; }

  /// Items of the ring that were undecided at the last look().
  [[nodiscard]] ipc::Word undecided() const { return producer_.appended() - found_.consumed; }

  /// Who refused the row that stops the replay.
  [[nodiscard]] std::optional<RefusedBy> stopped() const noexcept { return stopped_; }

 private:
  void begin_log();
  void note_refusal(const ItemRefusal& refused);
  void note(const RefusedRow& row, const std::string& message);

  const Recording& recording_;
  const ReplayOptions& options_;
  Producer& producer_;
  RefusedRows& refused_;
  std::optional<StreamLog> log_;  ///< with `verify`
  bool has_begun_ = false;
  std::function<void()> require_readable_;
  Refusals found_;  ///< of the last look()
  ipc::Word missed_ = 0;
  std::deque<PlayedRow> in_ring_;  ///< from item next_item_ on: not known to be consumed
  ipc::Word next_item_ = 0;
  std::vector<double> old_end_;  ///< see expect_start()
  ipc::Word sent_ = 0;
  ipc::Word refused_by_producer_ = 0;
  std::optional<RefusedBy> stopped_;
};

}  // namespace splinecast::apps
