#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "core/laws/rate_plan.hpp"
#include "ipc/law/commander_table.hpp"
#include "ipc/law/commands.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The rate of a law as its commanders request it: the curve that is in force, and a table of its
/// commanders with the bound of each. See core/laws/rate_plan.hpp for the rules. A change is
/// planned first, and is in force only when its caller has seen it committed. One thread uses it.
/// Allocates only when constructed.
class CommandedRate {
 public:
  /// Of a law with this largest rate.
  explicit CommandedRate(double largest);

  /// Plans the beginning of a law: each commander that is there is bounded by its request. Returns
  /// the rate with which the law begins.
  [[nodiscard]] double plan_beginning(const Commanders& commanders) noexcept;

  /// Continues a law with the curve that is in force and the table of its board. A row that no
  /// solver has written counts as free.
  void take_over(const core::RateCurve& curve, const CommanderTable& table) noexcept;

  /// Plans the rate from `t` on, which is of plan_begin(), after `commanders` has been read. A
  /// request changes a bound if its rate or its ramp is another; a renewal does not. A dead man
  /// that has fired remains so until the commander makes another request. A commander without a
  /// region any more counts as released. Nothing if the curve needs no change now.
  [[nodiscard]] std::optional<core::RateCurve> plan(const Commanders& commanders, Time t) noexcept;

  /// When a plan can begin that would begin at `t`: see core::plan_begin().
  [[nodiscard]] Time plan_begin(Time t) const noexcept {
    return core::plan_begin(in_force_.curve, t);
  }

  /// Whether the last plan changes anything that the board has: the curve or the table.
  [[nodiscard]] bool has_changes() const noexcept { return has_changes_; }

  /// Whether the last plan has a row for the commander with this id.
  [[nodiscard]] bool knows(Word id) const noexcept {
    return std::ranges::find(planned_.commanders, id, &CommanderEntry::id) !=
           planned_.commanders.end();
  }

  /// The table of the last plan.
  [[nodiscard]] const CommanderTable& table() const noexcept { return planned_.table; }

  /// The commander whose request the last plan follows: its slot, and the number of the request.
  [[nodiscard]] std::uint8_t slot() const noexcept { return planned_.slot; }
  [[nodiscard]] Word request() const noexcept { return planned_.commanders[planned_.slot].number; }

  /// The last plan has been committed.
  void commit() noexcept { in_force_ = planned_; }

 private:
  struct State {
    std::array<CommanderEntry, kMostCommanders> commanders;  ///< by slot
    CommanderTable table{};                                  ///< the same, as words
    core::RateCurve curve{1};
    Time ramp = kShortestRamp;  ///< of the newest request
    std::uint8_t slot = 0;      ///< of the commander that made it
  };

  [[nodiscard]] CommanderEntry* find(Word id) noexcept;
  [[nodiscard]] CommanderEntry* enter(const CommanderState& state, double rate) noexcept;
  void take_requests(const Commanders& commanders, Time t) noexcept;
  void forget(const Commanders& commanders, Time t) noexcept;
  void write_table() noexcept;
  [[nodiscard]] double target() const noexcept;

  double largest_;
  State in_force_;
  State planned_;
  bool has_changes_ = false;
  std::vector<core::RateCurve> bounds_;  ///< scratch
};

}  // namespace splinecast::ipc
