#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ipc/board/named_board.hpp"
#include "ipc/law/commander_table.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The commanders of a time law as its board has them: what is in force. One thread uses it.
class LawBoard {
 public:
  LawBoard(std::string law, const Trust& trust) : board_(std::move(law), trust) {}

  /// Looks whether there is a board with a revision, and opens it; opens it again if the law has
  /// been removed and recreated. A board that cannot be used counts as none. System calls unless
  /// one is open. The functions below require the result true.
  [[nodiscard]] bool is_there() noexcept;

  /// The largest rate that the law can have.
  [[nodiscard]] double max_rate() const noexcept { return ipc::max_rate(board_.header()); }

  /// The row of the commander whose region has this id; nothing if there is none.
  [[nodiscard]] std::optional<CommanderEntry> commander(Word id) const noexcept;

  /// The rows in use.
  [[nodiscard]] std::vector<CommanderEntry> commanders() const;

  /// Sleeps until the board has another revision than in the last call of commander(), at most
  /// `timeout`. May return early.
  void wait(Time timeout) const noexcept;

 private:
  NamedBoard board_;
  mutable Word seen_ = 0;
};

/// The name in a row.
[[nodiscard]] std::string name_of(const CommanderEntry& entry);

}  // namespace splinecast::ipc
