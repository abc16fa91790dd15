#pragma once

#include <string>
#include <variant>

#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A board of which this process is the writer, created or taken over.
struct OwnedBoard {
  Region region;
  RegionLock lock;
  RegionHeader header;
  bool taken_over;
  KnotBoardWriter writer;
  KnotBoardReader reader;

  OwnedBoard(Region mapped, const RegionHeader& described, const BoardLayout& layout, bool old);
};

/// The board of an earlier stream occupies the name until this host time, when its motion ends.
struct Occupied {
  Time until;
};

/// Takes over the board of the stream whose ring has this header, or creates one. `clock` is the
/// host's. The caller holds the solver's lock. Throws as Solver::attach does.
[[nodiscard]] std::variant<OwnedBoard, Occupied> own_board(const std::string& stream,
                                                           const RegionHeader& ring_header,
                                                           const SolverOptions& options,
                                                           const Clock& clock);

}  // namespace splinecast::ipc
