#pragma once

#include <span>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// What a planner has made for a revision.
struct LawPlan {
  /// The table of the law's commanders for the revision: kCommanderTableWords words, valid until
  /// the next plan. Empty: as the last revision has it.
  std::span<const Word> table;
  bool must_commit = false;  ///< the table has changed: a revision is needed also without an item
};

/// Plans a time law within the step of the solver that publishes it, so that no plan can be late.
class LawPlanner {
 public:
  LawPlanner() = default;
  LawPlanner(const LawPlanner&) = delete;
  LawPlanner& operator=(const LawPlanner&) = delete;
  virtual ~LawPlanner() = default;

  /// Appends to the law's ring the items that the law needs now, if any: its beginning, or one
  /// plan from `settled` on or later. The step takes them at once, or discards its revision and
  /// withdraws them. `now`: the host time that the step has read; `settled`: the law does not
  /// change before. Bounded; makes no system call and does not allocate.
  virtual LawPlan plan(Time now, Time settled) noexcept = 0;
};

}  // namespace splinecast::ipc
