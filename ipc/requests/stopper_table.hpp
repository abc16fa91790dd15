#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "ipc/layout/request_control.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/requests/stoppers.hpp"

namespace splinecast::ipc {

/// A stopper as a board has it.
struct StopperEntry {
  Word id = 0;
  std::string name;  ///< or the beginning of a longer one
  Word number = 0;   ///< of its newest request that is in force
  bool holds = false;
  bool is_damaged = false;
};

/// The stoppers of a stream as its board has them: what is in force. Allocates nothing.
class StopperTable {
 public:
  using Words = std::array<Word, kStopperTableWords>;

  /// Continues with a committed table, of which this number of stoppers hold the stream.
  void restore(std::span<const Word, kStopperTableWords> committed, Word holders) noexcept;

  /// Enters what the stoppers request. A stopper keeps its slot until its region is gone, or until
  /// it does not hold the stream and one that does needs the slot. One that gets no slot is not
  /// named, but holds the stream all the same. O(stoppers); O(1) if there is none.
  void update(std::span<const StopperState> states) noexcept;

  [[nodiscard]] const Words& words() const noexcept { return words_; }

  /// Whether update() has changed anything since restore() or committed().
  [[nodiscard]] bool has_changes() const noexcept { return has_changes_; }
  void committed() noexcept { has_changes_ = false; }

  /// Number of stoppers that hold the stream, and the slot of one of them.
  [[nodiscard]] Word holders() const noexcept { return holders_; }
  [[nodiscard]] Word holder() const noexcept { return holder_; }

 private:
  [[nodiscard]] std::optional<std::size_t> find(Word id) const noexcept;
  [[nodiscard]] std::optional<std::size_t> find_name(const std::string& name) const noexcept;
  [[nodiscard]] std::optional<std::size_t> give_slot(const StopperState& state) noexcept;
  void put(std::size_t word, Word value) noexcept;
  void clear(std::size_t slot) noexcept;

  Words words_{};
  Word holders_ = 0;
  Word holder_ = 0;
  bool is_used_ = false;  ///< a slot may be in use
  bool has_changes_ = false;
};

/// The stopper in a slot; nothing if the slot is free. Allocates.
[[nodiscard]] std::optional<StopperEntry> stopper_in(const StopperTable::Words& words,
                                                     std::size_t slot);

}  // namespace splinecast::ipc
