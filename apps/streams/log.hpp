#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/streams/own_board.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/verification/sent_items.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

/// Keeps what a process sends to a stream and the segments that come of it, in order to solve them
/// again at the end. Holds all of both in memory.
class StreamLog {
 public:
  /// Opens the board of the stream with this id, which has been sent nothing yet. Throws as
  /// OwnBoard does.
  StreamLog(const std::string& stream, std::uint64_t stream_id, const Trust& trust);

  /// Notes a waypoint that the ring has accepted.
  void sent(const Waypoint& waypoint) { items_.add(ipc::ItemKind::waypoint, waypoint); }

  /// Notes an item that the solver has refused.
  void refused(ipc::Word item) noexcept { items_.refuse(item); }

  /// Takes what has settled: to be called before the board loses it. See ipc::SettledSegments.
  void look() { settled_.look(); }

  /// Solves all that was collected again, of a stream that was finished with `end`. See
  /// ipc::verify.
  [[nodiscard]] ipc::Verification verify(const Condition& end);

 private:
  OwnBoard board_;
  ipc::SettledSegments settled_;
  ipc::SentItems items_;
};

/// What a verification found, in words and as JSON.
[[nodiscard]] std::string in_words(const ipc::Verification& found);
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::Verification& found);

}  // namespace splinecast::apps
