#pragma once

#include <functional>
#include <string>

#include "splinecast/ipc/segment_board.hpp"
#include "support/own_board.hpp"

namespace splinecast::apps {

/// Follows what a solver refuses while it goes on: a passive reader of the stream's board.
///
/// The board keeps the last ipc::kRefusalsKept refusals; whoever looks again before so many items
/// have been consumed misses none.
class RefusalWatch {
 public:
  /// Opens the board of the stream with this id and begins behind what has been refused so far.
  /// Throws NoSuchStream, BadRegion, or Failure if another stream stands under the name.
  RefusalWatch(const std::string& stream, std::uint64_t stream_id, const ipc::Trust& trust);

  /// Looks once; calls `refused` for each refusal that is new, in order. O(1) where nothing was
  /// published since; no system call.
  void look(const std::function<void(const ipc::RefusedItem&)>& refused);

  /// The head under which `look` last saw the board.
  [[nodiscard]] const ipc::Head& head() const noexcept { return head_; }

  /// Refusals that were overwritten before they were seen.
  [[nodiscard]] ipc::Word missed() const noexcept { return missed_; }

 private:
  [[nodiscard]] bool copy_head();

  OwnBoard board_;
  ipc::Head head_;
  ipc::Word seen_ = 0;  ///< refusals dealt with, over the stream's life
  ipc::Word missed_ = 0;
};

}  // namespace splinecast::apps
