#pragma once

#include <cstddef>
#include <variant>

#include "core/motion/end.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// How a published curve returns to its target.
struct EntryOptions {
  bool is_live = false;       ///< false: an entry waits until K newer waypoints are known
  Time min_entry{};           ///< length of the shortest entry
  Time notice{};              ///< a live stream's start is decided this long before it settles
  bool keeps_limits = false;  ///< Beyond::enter: the curve leaves its target where that exceeds one
  bool checks_stops = false;  ///< the stop after a waypoint counts, too: not Beyond::report
};

/// What a curve that must keep its limits has done with a waypoint.
enum class Followed {
  taken,    ///< it has been appended
  waits,    ///< nothing: offer it again in the next step, after the commit
  refused,  ///< nothing: the curve cannot follow its waypoints
};

/// The state from which an entry, or the stop of a run without waypoints, begins.
struct CurveOrigin {
  Word number = 0;  ///< of its knot; 0: there is no such entry or stop
  Time time{};
  bool is_new = false;     ///< the board does not hold it yet
  bool is_corner = false;  ///< the run began from rest there
  Word stopped_by = 0;     ///< a stopper's stop begins there: see stop_item(); 0: none
};

/// The end that is tried: slowing down, or an entry to the last waypoint from there.
enum class EndAttempt {
  slowing,       ///< slowing down from a knot of the published curve
  from_knots,    ///< at knots of the published curve, the latest one first
  from_settled,  ///< in the published curve, as it settles
  from_rest,     ///< where the published curve rests
};

/// Whether a curve has been finished: not yet, or its end is being searched for, or it has one.
struct Unfinished {};
struct SearchingEnd {
  EndAttempt attempt{};
  std::size_t knot = 0;  ///< from_knots: the knot after the one that is tried
};
struct Ended {
  EndKind kind{};
  Time rest{};  ///< `entered`: when the entry comes to rest
};
using FinishState = std::variant<Unfinished, SearchingEnd, Ended>;

/// The course that a summary has for an end.
[[nodiscard]] constexpr Course course_of(const core::End& end) noexcept {
  return static_cast<Course>(end.index());
}
static_assert(std::variant_size_v<core::End> == kCourses);
static_assert(course_of(core::OnTarget{}) == Course::on_target);
static_assert(course_of(core::Waiting{}) == Course::waiting);
static_assert(course_of(core::Entering{}) == Course::entering);
static_assert(course_of(core::EnteringAhead{}) == Course::beyond);
static_assert(course_of(core::Starting{}) == Course::starting);
/// An end of this course, without its values.
[[nodiscard]] core::End end_of(Course course) noexcept;

/// A published curve's part of a revision's summary; see the members of Summary.
struct CurveSummary {
  Word first = 0;
  Word newest = 0;
  Time stop{};
  Word run = 1;
  Word run_knots = 0;
  Word run_item = 0;
  Word run_frozen = 0;
  bool is_later_run = false;
  Course course{};
  Word met = 0;
  Word unmet = 0;
  Word goal = 0;  ///< the open entry ends beyond, at the waypoint before this one; 0: at none
  Time blend_until{};
  Word passed_over = 0;
  Time unmet_since = Time::max();
  Time refused_until = Time::max();
};

/// Copies the curve's part into a summary; the counters stay as they are.
void put_summary(const CurveSummary& curve, Summary& summary) noexcept;

}  // namespace splinecast::ipc
