#include "ipc/verification/run_restart.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "core/slopes/rule.hpp"
#include "ipc/runs/sound_knot.hpp"

namespace splinecast::ipc {
namespace {

std::vector<double> to_vector(std::span<const double> values) {
  return {values.begin(), values.end()};
}

/// The number of the first knot of the target's last piece: from there on, each knot on the board
/// is a waypoint of the run. 0 if the curve is not on its target.
Word first_on_target(const Summary& summary) noexcept {
  const auto course = static_cast<Course>(summary.course);
  const bool is_on_target = course == Course::on_target || course == Course::entering;
  if (!is_on_target || summary.run_item == 0 || summary.run_knots <= summary.met) return 0;
  const Word after = summary.run_knots - summary.met - 1;
  return summary.newest > after ? summary.newest - after : 0;
}

/// Copies a knot with its row; empty if the board no longer has it, or if it is not a waypoint.
std::optional<RestartKnot> copy(const KnotBoardReader& board, Word r, Word number,
                                bool needs_acceleration, KnotCopy& scratch) {
  if (!board.copy_knot(number, r, scratch) || !scratch.note.is_waypoint ||
      scratch.note.form == core::SegmentForm::none ||
      scratch.note.form == core::SegmentForm::slowed) {
    return std::nullopt;
  }
  RestartKnot knot{.time = scratch.time,
                   .waypoint = to_vector(scratch.waypoint()),
                   .g = std::vector<double>(board.dimensions()),
                   .position = std::vector<double>(board.dimensions()),
                   .velocity = to_vector(scratch.velocity()),
                   .acceleration = to_vector(needs_acceleration ? scratch.acceleration()
                                                                : std::span<const double>{}),
                   .residual = to_vector(scratch.residual())};
  core::write_position(scratch.end(), knot.position);
  if (!board.observe_row(scratch, r, knot.g, knot.prefix)) return std::nullopt;
  return knot;
}

bool is_sound(const RestartKnot& knot, std::size_t dimensions, bool smooths) noexcept {
  const auto fits = [dimensions](std::span<const double> values, bool is_optional) {
    return values.size() == dimensions || (is_optional && values.empty());
  };
  return fits(knot.waypoint, false) && fits(knot.g, false) && fits(knot.position, false) &&
         fits(knot.velocity, false) && fits(knot.acceleration, true) &&
         fits(knot.residual, !smooths) && ipc::is_sound(knot.view());
}

}  // namespace

core::Knot RestartKnot::view() const noexcept {
  return {.time = time,
          .prefix = prefix,
          .newer_knots = 0,
          .waypoint = waypoint,
          .g = g,
          .position = position,
          .velocity = velocity,
          .acceleration = acceleration,
          .residual = residual};
}

std::size_t knots_to_restart(const core::WindowOptions& options) noexcept {
  return std::max<std::size_t>(options.settle, 1) + core::kMaxReach + 3;
}

bool is_sound(const RunRestart& restart, std::size_t dimensions,
              const core::WindowOptions& options) noexcept {
  const std::size_t most = knots_to_restart(options);
  if (restart.knots.empty() || restart.knots.size() > most || restart.first >= Word{1} << 62U) {
    return false;
  }
  if (restart.first > 0 && restart.knots.size() < most) return false;
  const auto is_not_before = [](const RestartKnot& a, const RestartKnot& b) {
    return a.time >= b.time;
  };
  const Method& method = *options.interpolant.method;
  return std::ranges::adjacent_find(restart.knots, is_not_before) == restart.knots.end() &&
         std::ranges::all_of(restart.knots, [&](const RestartKnot& knot) {
           return is_sound(knot, dimensions, method.smooths()) &&
                  method.needs_acceleration() == !knot.acceleration.empty();
         });
}

std::optional<RunRestart> copy_restart(const KnotBoardReader& board, const Summary& summary,
                                       const core::WindowOptions& options, Word number) {
  const Word oldest = first_on_target(summary);
  if (oldest == 0 || number < oldest || number >= summary.newest) return std::nullopt;
  const Word index = summary.run_knots - 1 - (summary.newest - number);
  const Word count = std::min<Word>(index + 1, knots_to_restart(options));
  if (number + 1 < count + std::max(oldest, summary.first)) return std::nullopt;
  RunRestart restart{.is_later_run = summary.is_later_run,
                     .run_item = summary.run_item - 1,
                     .first = index + 1 - count};
  KnotCopy scratch(board.dimensions(), board.smooths());
  for (Word k = number + 1 - count; k <= number; ++k) {
    auto knot =
        copy(board, summary.revision, k, options.interpolant.method->needs_acceleration(), scratch);
    if (!knot) return std::nullopt;
    restart.knots.push_back(std::move(*knot));
  }
  return restart;
}

}  // namespace splinecast::ipc
