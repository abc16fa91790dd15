#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "apps/recordings/refused_rows.hpp"
#include "apps/replay/player.hpp"
#include "apps/streams/log.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {

/// A row of a recording in one of the loops in which it is played, both from 0.
struct PlayedRow {
  std::size_t row;
  std::size_t loop;
};

/// Which rows a replay has sent, and who refused which of them: what the solver refuses by its
/// number in the ring is named by its line.
class SentRows {
 public:
  SentRows(const WaypointTable& table, const ReplayOptions& options, Producer& producer,
           RefusedRows& refused)
      : table_(table), options_(options), producer_(producer), refused_(refused) {}

  /// Leaves out what was refused of a producer before this one. If it is to be verified, keeps all
  /// that is sent from now on; throws InputError if that would not be all of the stream.
  void begin();

  /// The next row is the ring's next item.
  void begin_rows() { next_item_ = producer_.appended(); }

  /// Notes a row that the ring has accepted.
  void note_sent(const PlayedRow& row, const Waypoint& waypoint);

  /// Notes a row that the append refused: it is not in the ring.
  void note_refusal(const PlayedRow& row, Time time, AppendStatus status);

  /// Notes what the solver has refused since the last look. The board keeps the last refusals only:
  /// so this is called with every waypoint, and costs next to nothing where nothing was published
  /// since.
  void look();

  /// Looks for the last time, and counts the refusals that could not be named.
  void finish();

  /// Solves what was sent again; nothing if that is not asked for.
  [[nodiscard]] std::optional<ipc::Verification> verify(const Condition& end);

  /// Rows that the ring has accepted, and that the append refused.
  [[nodiscard]] ipc::Word sent() const noexcept { return sent_; }
  [[nodiscard]] ipc::Word refused_by_producer() const noexcept { return refused_by_producer_; }

  /// Items of the ring that were not decided when it looked last.
  [[nodiscard]] ipc::Word undecided() const { return producer_.appended() - found_.consumed; }

  /// Who refused the row that stops the replay.
  [[nodiscard]] std::optional<RefusedBy> stopped() const noexcept { return stopped_; }

 private:
  void begin_log();
  void note_refusal(const ItemRefusal& refused);
  void note(const RefusedRow& row, const std::string& message);

  const WaypointTable& table_;
  const ReplayOptions& options_;
  Producer& producer_;
  RefusedRows& refused_;
  std::optional<StreamLog> log_;  ///< if it is to be verified
  Refusals found_;                ///< by the last look
  ipc::Word missed_ = 0;
  std::deque<PlayedRow> in_ring_;  ///< from item next_item_ on: not known to be consumed
  ipc::Word next_item_ = 0;
  ipc::Word sent_ = 0;
  ipc::Word refused_by_producer_ = 0;
  std::optional<RefusedBy> stopped_;
};

}  // namespace splinecast::apps
