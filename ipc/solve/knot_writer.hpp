#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "core/motion/plan.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/runs/slowed_end.hpp"
#include "splinecast/method.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The course that a summary has for an end.
[[nodiscard]] constexpr Course course_of(const core::End& end) noexcept {
  return static_cast<Course>(end.index());
}
static_assert(std::variant_size_v<core::End> == kCourses);
static_assert(course_of(core::OnTarget{}) == Course::on_target);
static_assert(course_of(core::Waiting{}) == Course::waiting);
static_assert(course_of(core::Entering{}) == Course::entering);
static_assert(course_of(core::EnteringAhead{}) == Course::ahead);
static_assert(course_of(core::Starting{}) == Course::starting);

/// The knot of a plan's origin.
struct CurveOrigin {
  Word number = 0;
  bool is_new = false;     ///< the board does not hold it yet
  bool is_corner = false;  ///< the run began from rest there
  Word stopped_by = 0;     ///< a stopper's stop begins there: see stop_item(); 0: none
};

/// Writes a plan as knots on the board. Knows which knots of it are written and which are
/// committed, and nothing else of the plan: a function whose name says what has been done to the
/// plan is called after that, with the same plan each time.
///
/// Knots on the board have consecutive numbers, run after run: `Summary::run` is the first knot of
/// a run, which is its first waypoint or the state that it was entered from. Waypoints that the
/// curve passes over have slots of their own, for a solver that takes over.
///
/// Allocates only when constructed; one thread uses it.
class KnotWriter {
 public:
  /// Number of knots before the passed-over ones that a window needs to continue: as many as a row
  /// and a slope depend on.
  static constexpr std::size_t kMetKept = core::kMaxReach + 3;

  /// `board` and `published` are the two sides of one board; both outlive the writer.
  KnotWriter(KnotBoardWriter& board, const KnotBoardReader& published, const Method& method);

  /// Continues from the last commit, whose summary is `summary`: its plan has been restored, its
  /// curve comes to rest at `rest`, and `origin` is the knot of the plan's origin.
  void restore(const core::Plan& plan, const Summary& summary, Time rest,
               const CurveOrigin& origin) noexcept;

  /// Prefetches the memory outside this object that the next append touches.
  void prefetch(const core::Plan& plan) const noexcept;

  /// Whether anything has been changed since the last commit.
  [[nodiscard]] bool has_changes() const noexcept { return has_changes_; }

  /// The newest knot on the board; 0: none.
  [[nodiscard]] Word newest() const noexcept { return newest_; }
  [[nodiscard]] Word first() const noexcept { return first_; }

  /// The time at which the curve on the board comes to rest.
  [[nodiscard]] Time rest() const noexcept { return rest_; }

  /// The knot of the plan's origin. Means nothing if the plan has none.
  [[nodiscard]] const CurveOrigin& origin() const noexcept { return origin_; }

  /// Number of knot i ≥ plan.met() of the run.
  [[nodiscard]] Word number_of(const core::Plan& plan, std::size_t knot) const noexcept {
    return met_number_ + knot - plan.met();
  }

  /// Whether the board can take this many more knots after knot `number`, or after those of the
  /// plan, without losing a segment that ends after `keep`.
  [[nodiscard]] bool has_room_after(Word number, std::size_t knots, Time keep) const noexcept;
  [[nodiscard]] bool has_room(const core::Plan& plan, std::size_t knots, Time keep) const noexcept;

  void begun(const core::Plan& plan) noexcept;
  /// `origin`: the new one, which the cut has been made for.
  void cut(const core::Plan& plan, const CurveOrigin& origin) noexcept;
  void appended(const core::Plan& plan, Word item) noexcept;
  /// After plan.leave_target_at(), and when plan.freeze() has returned Frozen::left_target.
  void left_target(const core::Plan& plan) noexcept;
  void rests_at_start(const core::Plan& plan) noexcept;
  void starts_on_target(const core::Plan& plan) noexcept;
  void starts_by_entry() noexcept { has_changes_ = true; }
  /// `origin`: the number of the knot of a new origin; nothing if the entry begins in the old one.
  void entered(const core::Plan& plan, std::optional<Word> origin) noexcept;
  void ended_by_entry(const core::Plan& plan, std::optional<Word> origin) noexcept;
  void ended_on_target(const core::Plan& plan) noexcept;
  void ended_in_stop(const core::Plan& plan) noexcept;
  void slowed_from(Time t) noexcept { note_change(t); }

  /// Records which knots are final. Call it when all knots are on the board, before a revision
  /// changes any.
  void keep_settled(const core::Plan& plan) noexcept;

  /// Writes the changes to the board; `slowed` is the end of a plan that ends so. Returns the
  /// earliest time at which the curve changes; max() if it does not change; nothing if the board
  /// holds data that no solver wrote.
  [[nodiscard]] std::optional<Time> write(const core::Plan& plan, SlowedEnd& slowed) noexcept;

  /// Writes the curve's part of the summary, as of the last write.
  void write_summary(const core::Plan& plan, Summary& out) const noexcept;

  /// Call after the commit.
  void committed(const core::Plan& plan) noexcept;

 private:
  /// Knots of the run in the passed slots, `lowest` to before `written` unless newer ones are.
  struct PassedKnots {
    std::size_t lowest = 0;  ///< up to kMetKept before unmet(); 0 if a stream starts by an entry
    std::size_t written = 0;
    std::size_t committed = 0;  ///< `written`, as of the last commit
  };

  void note_change(Time from) noexcept;
  void write_origin(const core::Plan& plan) noexcept;
  void write_ahead(const core::Plan& plan, const core::EnteringAhead& ahead) noexcept;
  void write_ending(const core::Plan& plan) noexcept;
  void write_passed(const core::Plan& plan, std::size_t first, std::size_t end) noexcept;
  void write_unmet(const core::Plan& plan, std::size_t end) noexcept;
  [[nodiscard]] std::size_t plain_knots(const core::Plan& plan) const noexcept;
  void write_knots(const core::Plan& plan, std::size_t first, std::size_t end) noexcept;
  void write_knot(const core::Plan& plan, std::size_t i) noexcept;
  void write_stop(const core::Plan& plan, bool ends_entry, KnotRecord& record) noexcept;
  void give_row(std::size_t i, const core::Knot& knot, KnotRecord& record) const noexcept;
  void write_off_target(const core::Plan& plan, bool writes_origin) noexcept;
  void write_on_target(const core::Plan& plan) noexcept;
  void drop_oldest() noexcept;

  KnotBoardWriter* board_;
  const KnotBoardReader* published_;
  std::size_t look_ahead_;  ///< how many rows before the newest knot an append may change
  bool has_plain_knots_;    ///< an append changes only the velocities of older knots
  Word run_ = 1;
  Word run_item_ = 0;  ///< item of the run's first waypoint, plus 1
  Word first_ = 0;
  Word newest_ = 0;
  Time rest_{};
  Time stop_{};  ///< length of the stop, if the newest segment is one
  CurveOrigin origin_;
  bool is_entry_new_ = false;  ///< the entry has not been written
  bool has_changes_ = false;
  Time changed_from_ = Time::max();
  std::size_t committed_knots_ = 0;  ///< number of knots of the run at the last commit
  // Numbers of leading knots of the run that
  std::size_t kept_ = 0;        ///< have settled, as of the last freeze: unchanged since the commit
  std::size_t first_open_ = 0;  ///< are written with their final values
  std::size_t placed_ = 0;      ///< have been written to the numbered slots
  Word met_number_ = 1;         ///< number of knot plan.met() of the run
  PassedKnots passed_;
  std::vector<double> values_;  ///< scratch
  core::Segment segment_;       ///< scratch
};

}  // namespace splinecast::ipc
