#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/motion/end.hpp"
#include "core/motion/extrapolation.hpp"
#include "core/motion/slowed_path.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/runs/run_edges.hpp"
#include "ipc/verification/begin_state.hpp"
#include "ipc/verification/promises/stop.hpp"
#include "ipc/verification/recorded_decisions.hpp"
#include "ipc/verification/run_target.hpp"
#include "ipc/verification/stream_record.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Solves a recorded stream again, segment by segment, with the solver's decisions as its segments
/// show them, up to the first segment that differs. Used once, by one thread.
class StreamReplay {
 public:
  /// The record outlives this. `late_cuts`: the segments at which a replacement has cut a run
  /// without waypoints later than at its own time. Throws std::invalid_argument for window options
  /// out of range.
  explicit StreamReplay(const StreamRecord& record, std::set<std::size_t> late_cuts = {});

  [[nodiscard]] Verification run();

  /// After a difference: the segment at which the run of that place begins, if a late replacement
  /// may have cut it there, which is not recorded. If so, it is one of the late cuts.
  [[nodiscard]] std::optional<std::size_t> open_cut() const noexcept { return open_cut_; }

 private:
  // Parts of a curve, and the transitions between them.
  void solve_part();
  bool follows(std::size_t i);
  void begin_part();
  void solve_run(std::size_t i);
  void solve_rest_of_run(std::size_t i);
  bool begin_run(std::size_t i);
  [[nodiscard]] std::optional<Word> waypoint_at(Time time) const noexcept;
  bool list_met(std::size_t begin, std::size_t end);
  bool note_met(std::size_t s, Time time, std::size_t newer);
  bool note_slowed(std::size_t s, std::size_t end);
  bool append_until(std::size_t count);
  bool rests_at_last_waypoint();
  [[nodiscard]] bool ends_in_stop() const noexcept;
  bool expect_all_used(Word end);
  [[nodiscard]] bool has_former_rules() const noexcept { return record_.rules == kFormerRules; }
  [[nodiscard]] bool is_last_run() const noexcept { return decisions_.is_last_run(run_item_); }
  [[nodiscard]] bool begins_at_end(std::size_t i) const noexcept;

  // Each solves one segment into solved_, and compares it with the published one.
  bool solve_in_run(std::size_t s);
  bool solve_on_target(std::size_t s);
  bool solve_entry(std::size_t s);
  bool solve_after_entry(std::size_t s);
  bool solve_state_stop(std::size_t s);
  bool solve_stop(std::size_t s, const Instant& from, StopPart part);
  [[nodiscard]] Time stop_length_after(std::size_t s) const noexcept;
  bool solve_hold_after(std::size_t s);
  bool solve_slowed(std::size_t s);
  bool solve_path(std::size_t s);
  void solve_hold(std::size_t i);
  void solve_ending(std::size_t i);
  bool compare_solved(std::size_t i);
  void advance() noexcept;
  bool differ(std::size_t i, std::string what, std::string published, std::string solved);
  bool differ(std::size_t i, Difference difference);

  const StreamRecord& record_;
  std::set<std::size_t> late_cuts_;
  std::optional<std::size_t> open_cut_{};
  std::span<const SegmentCopy> segments_;
  RecordedDecisions decisions_;
  RunTarget target_;
  BeginState begin_;
  core::Segment solved_;
  State end_;  ///< scratch: state at the end of an entry
  core::Extrapolation extrapolation_;
  core::SlowedPath path_;
  core::Segment piece_;                     ///< scratch: of the path
  std::size_t slowed_ = 0;                  ///< segment at which the curve begins to slow down
  std::vector<double> values_;              ///< scratch
  std::vector<double> begin_acceleration_;  ///< scratch: of a recorded stop
  std::optional<Word> run_item_{};
  Time natural_right_{};  ///< where the segment before ends without a cut
  std::size_t next_ = 0;  ///< segment to be compared next
  std::size_t equal_ = 0;
  std::optional<Difference> first_;
};

}  // namespace splinecast::ipc
