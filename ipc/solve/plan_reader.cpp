#include "ipc/solve/plan_reader.hpp"

#include <algorithm>

#include "core/forms/instant.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/runs/sound_knot.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

/// Whether a summary of an unfinished stream describes a possible run.
bool describes_a_run(const Summary& summary) noexcept {
  if (summary.course >= kCourses) return false;
  if (summary.newest == 0) {
    return summary.run_knots == 0 && summary.met == 0 && summary.unmet == 0 &&
           !summary.is_later_run;
  }
  const bool is_on_target = static_cast<Course>(summary.course) == Course::on_target ||
                            static_cast<Course>(summary.course) == Course::entering;
  const bool has_piece =
      !is_on_target || (summary.met < summary.run_knots &&
                        summary.run_knots - summary.met <= summary.newest - summary.run + 1);
  return summary.run >= 1 && summary.run <= summary.newest && summary.unmet <= summary.run_knots &&
         summary.met <= summary.run_knots && has_piece && summary.run_knots < Word{1} << 62U;
}

/// An end of this course, without its values.
core::End end_of(Course course) noexcept {
  switch (course) {
    case Course::on_target:
      break;
    case Course::waiting:
      return core::Waiting{};
    case Course::entering:
      return core::Entering{};
    case Course::ahead:
      return core::EnteringAhead{};
    case Course::starting:
      return core::Starting{};
  }
  return core::OnTarget{};
}

}  // namespace

PlanReader::PlanReader(const KnotBoardReader& published, const core::SlidingWindow& window)
    : published_(&published),
      origin_state_(published.dimensions()),
      entry_end_(published.dimensions()),
      knot_(published.dimensions(), published.smooths()),
      knots_(window.knots_to_restore()),
      values_(kKnotValues * published.dimensions() * window.knots_to_restore()) {}

bool PlanReader::read(const Summary& summary) noexcept {
  summary_ = summary;
  state_ = {};
  origin_ = {};
  count_ = 0;
  return describes_a_run(summary) && read_course() && read_knots();
}

bool PlanReader::read_knot(Word number) noexcept {
  return published_->copy_knot(number, summary_.revision, knot_);
}

/// Whether waypoint i of the run is in its passed slot, which has been read then.
bool PlanReader::is_passed(std::size_t i) noexcept {
  return published_->copy_passed(i, summary_.revision, knot_) &&
         knot_.item == (summary_.run_item << kPassedItemShift | i);
}

/// Reads how the curve ends, and the state at which the open entry, or the stop of a run without
/// waypoints, begins.
bool PlanReader::read_course() noexcept {
  state_ = {.end = end_of(static_cast<Course>(summary_.course)),
            .met = summary_.met,
            .unmet = summary_.unmet,
            .knots = summary_.run_knots,
            .frozen = summary_.run_frozen,
            .passed_over = summary_.passed_over,
            .is_later_run = summary_.is_later_run,
            .blend_until = summary_.blend_until,
            .unmet_since = summary_.unmet_since,
            .refused_until = summary_.refused_until};
  if (!core::is_on_target(state_.end)) state_.met = state_.knots;
  if (summary_.newest == 0 || core::is<core::OnTarget>(state_.end)) return true;
  if (auto* const entering = std::get_if<core::Entering>(&state_.end)) {
    const Word met = summary_.newest - (state_.knots - std::min(state_.knots, state_.met + 1));
    if (met - 1 < summary_.first) {
      // The entry is no longer on the board: it has ended.
      state_.end = core::OnTarget{};
      state_.unmet = state_.met;
      return true;
    }
    if (!read_origin(met - 1) || !read_knot(met) || !knot_.note.arrives) return false;
    entering->end = knot_.time;
    std::ranges::copy(knot_.acceleration(), entry_end_.ref().acceleration.begin());
    state_.entry_end = core::instant_of(knot_.time, entry_end_);
    return true;
  }
  Word number = summary_.newest;
  if (!read_knot(number)) return false;
  if (knot_.note.is_waypoint)
    return true;  // the curve ends with the stop after the newest met knot
  auto* const ahead = std::get_if<core::EnteringAhead>(&state_.end);
  if (ahead != nullptr && !read_ahead(*ahead, number)) return false;
  return read_origin(number);
}

bool PlanReader::read_origin(Word number) noexcept {
  if (number < summary_.run || !read_knot(number)) return false;
  const core::Knot knot = to_knot(values_);
  if (!is_sound(knot) || knot_.note.is_waypoint || knot.acceleration.empty()) return false;
  core::copy_values({knot.time, knot.position, knot.velocity, knot.acceleration}, origin_state_);
  state_.origin = core::instant_of(knot.time, origin_state_);
  origin_ = {.number = number,
             .is_corner = knot_.begins_at_rest(),
             .stopped_by = knot_.begins_stoppers_stop() ? knot_.item : 0};
  return true;
}

/// Reads the end of an entry ahead of the newest waypoint. `number` is that of the newest knot,
/// which has been read; it is set to that of the entry's beginning.
bool PlanReader::read_ahead(core::EnteringAhead& ahead, Word& number) noexcept {
  if (!knot_.note.arrives && (number < 2 || !read_knot(--number))) return false;
  if (!knot_.note.arrives || number < 2) return false;
  ahead.after = {.end = knot_.time};  // the other times are needed where an entry is written only
  core::copy_values({knot_.time, knot_.waypoint(), knot_.velocity(), knot_.acceleration()},
                    entry_end_);
  state_.entry_end = core::instant_of(knot_.time, entry_end_);
  ahead.known = std::min<Word>(knot_.item, summary_.run_knots);
  --number;
  ahead.ends_at_known =
      ahead.known > state_.unmet && is_passed(ahead.known - 1) && knot_.time == ahead.after.end;
  return true;
}

/// Reads the newest knots of the run, from which a window continues.
bool PlanReader::read_knots() noexcept {
  const std::size_t size = kKnotValues * published_->dimensions();
  const std::size_t end = knots_.size();
  const std::size_t most = std::min<std::size_t>(summary_.run_knots, end);
  for (Word number = summary_.newest; count_ < most; ++count_) {
    const std::size_t i = summary_.run_knots - 1 - count_;
    const auto is_there = find_knot(i, number);
    if (!is_there) return false;
    // Knots that the open entry does not need may no longer be on the board.
    if (!*is_there) return i + KnotWriter::kMetKept < state_.unmet;
    const std::size_t k = end - 1 - count_;
    knots_[k] = to_knot(std::span(values_).subspan(size * k, size));
    if (!is_sound(knots_[k])) return false;
    if (count_ > 0 && knots_[k].time >= knots_[k + 1].time) return false;
  }
  return true;
}

/// Converts the knot that was read last to a knot of the window. Its spans point into `values`.
core::Knot PlanReader::to_knot(std::span<double> values) noexcept {
  std::size_t used = 0;
  const auto place = [&] {
    const auto part = values.subspan(used, published_->dimensions());
    used += part.size();
    return part;
  };
  const auto keep = [&](std::span<const double> from) {
    const auto part = place();
    std::ranges::copy(from, part.begin());
    return part.first(from.size());
  };
  const auto g = place();
  const core::Prefix prefix = published_->copy_row(knot_, g);
  const auto position = place();
  core::write_position(knot_.end(), position);
  return {.time = knot_.time,
          .prefix = prefix,
          .newer_knots = knot_.note.newer_knots,
          .waypoint = keep(knot_.waypoint()),
          .g = g,
          .position = position,
          .velocity = keep(knot_.velocity()),
          .acceleration = keep(knot_.acceleration()),
          .residual = keep(knot_.residual())};
}

/// Reads knot i of the run, and returns whether the board has it; nothing if the board is damaged.
/// Call it from the newest knot backwards. Searches both places where the knot may be: the numbered
/// slots, where it is the last waypoint at or before `number` at which a segment begins, and its
/// passed slot. A knot is in both if it was passed over first and met later, or if it is one of the
/// last met knots and its row has changed since. Then the record of the later revision is used. If
/// both are of the same revision, the passed slot is used, because a cut rewrites the form of a
/// numbered knot.
std::optional<bool> PlanReader::find_knot(std::size_t i, Word& number) noexcept {
  const Word oldest = std::max(summary_.run, summary_.first);
  const bool has_passed = is_passed(i) && knot_.note.is_waypoint;
  const Time time = knot_.time;
  const Word revision = revision_of(knot_.tag);
  bool is_numbered = false;
  for (; !is_numbered && number >= oldest && number > 0; number -= is_numbered ? 0 : 1) {
    if (!read_knot(number)) return std::nullopt;
    is_numbered = knot_.note.is_waypoint && knot_.note.form != SegmentForm::none;
  }
  is_numbered = is_numbered && !(has_passed && knot_.time < time);
  if (is_numbered) --number;
  if (has_passed && (!is_numbered || revision_of(knot_.tag) <= revision)) return is_passed(i);
  return is_numbered;
}

}  // namespace splinecast::ipc
