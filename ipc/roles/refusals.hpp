#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ipc/board/knot_board.hpp"
#include "ipc/ring/waypoint_ring.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// An item that the ring had accepted and the solver refused.
struct ItemRefusal {
  Word item = 0;                     ///< number of the item: Producer::appended() before its append
  std::optional<core::Time> time{};  ///< of the item; unset if the ring has overwritten it
  Refusal reason{};
  std::optional<LimitExcess> excess{};  ///< of `beyond_limits`, unless the board has it no more
};

/// `item 17 refused: too late (time 123 ns)`; of one beyond a limit also where.
[[nodiscard]] std::string to_string(const ItemRefusal& refusal);

/// `acceleration of dimension 2 (wrist) is 12.5 at 456 ns, limit 10`, with the dimension's name if
/// there is one among these.
[[nodiscard]] std::string in_words(const LimitExcess& excess,
                                   std::span<const std::string> names = {});

/// What a solver has refused since it was asked the last time.
struct Refusals {
  std::vector<ItemRefusal> items{};  ///< in the order of the ring; at most kRefusalsKept
  Word missed = 0;    ///< further refusals, before these, that the board no longer has
  Word consumed = 0;  ///< items below this number are decided: refused ones are told by now
};

/// Follows what a solver refuses, from its board. One thread uses it.
class RefusalReader {
 public:
  /// Leaves out items below `first`.
  explicit RefusalReader(Word first = 0) : first_(first), copied_(kRefusalsKept) {}

  /// Leaves out what the board has counted so far.
  void skip(const KnotBoardReader& board) noexcept;

  /// Begins with the first refusal of another board of the same stream.
  void restart() noexcept;

  /// Gives the refusals since the last look. `ring` is the ring of the board's stream. O(1) if
  /// nothing was published since, else O(new refusals); no system call. Allocates only where
  /// `out.items` has to grow. `missed` is 0 if at most kRefusalsKept items were consumed since.
  void look(const KnotBoardReader& board, const WaypointRingReader& ring, Refusals& out);

 private:
  void copy_head(const KnotBoardReader& board) noexcept;

  Head head_;      ///< as last seen
  Word seen_ = 0;  ///< refusals told, over the stream's life
  Word first_;
  std::vector<RefusedItem> copied_;
};

}  // namespace splinecast::ipc
