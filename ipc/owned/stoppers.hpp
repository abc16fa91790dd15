#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/requests/stopper_table.hpp"

/// The stoppers of a stream as its board names them, by the newest revision.
namespace splinecast::ipc {

/// All of them. Empty without a revision, or if the writer overtook every try. Allocates.
[[nodiscard]] std::vector<StopperEntry> stoppers_of(const KnotBoardReader& board);

/// The names of those that hold the stream.
[[nodiscard]] std::vector<std::string> holders_of(const KnotBoardReader& board);

/// The name of the one in a slot; empty if there is none.
[[nodiscard]] std::string stopper_of(const KnotBoardReader& board, std::size_t slot);

}  // namespace splinecast::ipc
