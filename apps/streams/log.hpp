#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/streams/own_board.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/verification/sent_items.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// Keeps the items that a process sends to a stream and the resulting segments, to solve the items
/// again at the end and compare. Keeps all of them in memory.
class StreamLog {
 public:
  /// Opens the board of the stream with this id, before anything is sent. Throws as OwnBoard does.
  StreamLog(const std::string& stream, std::uint64_t stream_id, const Trust& trust);

  /// Records a waypoint that the ring has accepted.
  void sent(const Waypoint& waypoint) { items_.add(ipc::ItemKind::waypoint, waypoint); }

  /// Records a start state.
  void sent_start(const Waypoint& state) { items_.add(ipc::ItemKind::start_state, state); }

  /// Records the item of a replacement. Its waypoints follow as sent() ones.
  void sent_replacement(Time t) { items_.add(ipc::ItemKind::replace, {.time = t}); }

  /// Records an item that the solver has refused.
  void refused(ipc::Word item) noexcept { items_.refuse(item); }

  /// Copies the segments that have settled. Call it before the board overwrites them. See
  /// ipc::SettledSegments.
  void look();

  /// Solves the recorded items again and compares the segments. `end` is the condition with which
  /// the stream was finished. See ipc::verify.
  [[nodiscard]] ipc::Verification verify(const Condition& end);

 private:
  OwnBoard board_;
  std::unique_ptr<ipc::LawFollower> law_;  ///< that the stream follows, if it is there
  ipc::SettledSegments settled_;
  ipc::SentItems items_;
};

/// The result of a verification, as text and as JSON.
[[nodiscard]] std::string in_words(const ipc::Verification& found);
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::Verification& found);

}  // namespace splinecast::apps
