#pragma once

#include <optional>
#include <string>

#include "ipc/board/reader.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// A knot board of another process.
using BoardView = RegionView<KnotBoardReader>;

/// The board under a stream's name, for a process that waits for it. One thread uses it.
class NamedBoard {
 public:
  NamedBoard(std::string stream, const Trust& trust) : stream_(std::move(stream)), trust_(trust) {}

  [[nodiscard]] const std::string& stream() const noexcept { return stream_; }

  /// Whether there is a board; opens it, again if the stream has been removed and recreated. One
  /// that cannot be used counts as none. System calls unless one is open. The functions below
  /// require the result true.
  [[nodiscard]] bool is_there() noexcept;

  [[nodiscard]] const RegionHeader& header() const noexcept { return board_->header; }
  [[nodiscard]] const KnotBoardReader& reader() const noexcept { return board_->reader; }

  /// Sleeps until the board has another revision than `seen`, at most `timeout`. May return early.
  void wait(Word seen, Time timeout) const noexcept;

 private:
  std::string stream_;
  Trust trust_;
  std::optional<BoardView> board_;
};

}  // namespace splinecast::ipc
