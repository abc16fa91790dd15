#pragma once

#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Collects the refusals of a solver from its board. One thread uses it.
class RefusalReader {
 public:
  /// Never reports refusals of items before `first`.
  explicit RefusalReader(Word first = 0) : first_(first), copied_(kRefusalsKept) {}

  /// Skips the refusals that are on the board so far.
  void skip(const KnotBoardReader& board) noexcept;

  /// Starts again at the first refusal, for another board of the same stream.
  void restart() noexcept;

  /// Writes the refusals since the last call to `out`. `ring` is the ring of the board's stream.
  /// O(1) if nothing was published since, else O(new refusals); no system call. Allocates only if
  /// `out.items` has to grow. `missed` is 0 if at most kRefusalsKept items were consumed since.
  void look(const KnotBoardReader& board, const WaypointRingReader& ring, Refusals& out);

 private:
  Summary summary_;  ///< as last seen
  Word seen_ = 0;    ///< refusals reported, over the stream's life
  Word first_;
  std::vector<RefusalRecord> copied_;
};

}  // namespace splinecast::ipc
