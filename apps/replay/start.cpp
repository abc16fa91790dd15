#include "apps/replay/start.hpp"

#include <fmt/format.h>

#include <span>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "core/forms/way_between.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps {
namespace {

/// Starts the stream in a state at rest; `moved`: the user says that the machine is there.
Time start_at_rest(Producer& producer, std::span<const double> position, Time t, bool moved,
                   const Waypoint& first, const ipc::RegionHeader& board, SentRows& rows) {
  const DimensionKinds kinds = ipc::dimension_kinds(board);
  if (position.size() != first.position.size() || !kinds.takes(position)) {
    throw InputError(
        fmt::format("--start-from: {} values are not a position of a stream of {} dimensions",
                    position.size(), first.position.size()));
  }
  const std::vector<double> zeros(position.size());
  const std::vector<double> at(position.begin(), position.end());
  const AppendStatus status = producer.start_from(
      {.time = t, .position = at, .velocity = zeros, .acceleration = zeros}, {.moved = moved});
  if (status != AppendStatus::accepted) {
    throw InputError(fmt::format("--start-from: {}", to_string(status)));
  }
  rows.note_start({.time = t, .position = at, .velocity = zeros, .acceleration = zeros});
  core::WayBetween way(kinds, at.size());
  way.measure(at, first.position);
  return way.entry_time(ipc::window_options(board).limits);
}

}  // namespace

Time start_stream(Producer& producer, const std::optional<StartFrom>& where, const Waypoint& first,
                  const ipc::RegionHeader& board, SentRows& rows) {
  const Instant end = producer.old_end();
  const bool has_end = !end.position.empty();
  if (!where) {
    if (has_end) rows.expect_start(end.position);
    return {};
  }
  if (std::holds_alternative<FromFirst>(*where)) {
    (void)producer.start_from({.time = first.time, .position = first.position}, {.moved = true});
    return {};
  }
  if (const auto* values = std::get_if<std::vector<double>>(&*where)) {
    return start_at_rest(producer, *values, producer.now(), true, first, board, rows);
  }
  if (!has_end) return {};
  return start_at_rest(producer, end.position, end.time, false, first, board, rows);
}

std::string elsewhere_message(Producer& producer, const Waypoint& first) {
  return fmt::format(
      "{}: --start-from old (an entry from the old end), --start-from first (the machine was moved "
      "to the first waypoint), or --start-from VALUES (its measured position)",
      producer.why_elsewhere(first));
}

}  // namespace splinecast::apps
