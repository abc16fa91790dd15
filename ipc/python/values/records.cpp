#include "ipc/python/values/records.hpp"

#include <pybind11/stl.h>

#include <array>

#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/types.hpp"

namespace splinecast::python {
namespace {

std::string text(LimitKind kind) { return std::string(to_string(kind)); }

py::object peaks(const MotionPeaks& motion) {
  return type("MotionPeaks")(to_array(motion.velocity), to_array(motion.acceleration),
                             to_array(motion.jerk));
}

py::object array_or_none(std::span<const double> values) {
  if (values.empty()) return py::none();
  return to_array(values);
}

}  // namespace

py::object to_record(const LimitExcess& excess, const std::string& text_of_it) {
  return type("LimitExcess")(excess.item, excess.is_refused, text(excess.kind), excess.dimension,
                             excess.time.count(), excess.value, excess.limit, text_of_it);
}

py::object to_record(const Excess& excess) {
  return type("Excess")(excess.ratio, text(excess.kind), excess.dimension, excess.value,
                        excess.limit);
}

py::object to_record(const ItemRefusal& refusal, std::span<const std::string> names) {
  py::object time = py::none();
  if (refusal.time) time = py::int_(refusal.time->count());
  py::object excess = py::none();
  if (refusal.excess) excess = to_record(*refusal.excess, in_words(*refusal.excess, names));
  return type("ItemRefusal")(refusal.item, time,
                             member("Refusal", static_cast<std::uint8_t>(refusal.reason)), excess,
                             refusal.by);
}

py::object to_record(const Refusals& refusals, std::span<const std::string> names) {
  py::list items;
  for (const ItemRefusal& refusal : refusals.items) items.append(to_record(refusal, names));
  return type("Refusals")(items, refusals.missed, refusals.consumed);
}

py::object to_record(const ItemOutcome& outcome) {
  const bool is_in_force = outcome.kind == OutcomeKind::in_force;
  const bool is_refused = outcome.kind == OutcomeKind::refused;
  py::object time = py::none();
  if (outcome.time) time = py::int_(outcome.time->count());
  const auto given = [](bool has, const char* name, auto number) -> py::object {
    return has ? member(name, static_cast<std::uint8_t>(number)) : py::none();
  };
  return type("ItemOutcome")(member("OutcomeKind", static_cast<std::uint8_t>(outcome.kind)), time,
                             given(is_in_force, "OutcomeWay", outcome.way),
                             given(is_refused, "Refusal", outcome.reason), outcome.is_final);
}

py::object to_record(const std::optional<ReplacementBegin>& found) {
  if (!found) return py::none();
  return type("ReplacementBegin")(found->begin.count(), found->from_rest);
}

py::object to_record(const ReplacePreview& preview) {
  py::object waypoint = py::none();
  if (preview.waypoint) waypoint = py::int_(*preview.waypoint);
  return type("ReplacePreview")(member("AppendStatus", static_cast<std::uint8_t>(preview.status)),
                                preview.is_known, preview.begin.count(),
                                to_seconds(preview.duration), preview.from_rest, preview.enters,
                                waypoint, preview.passed_over, peaks(preview.entry),
                                peaks(preview.motion), to_record(preview.worst));
}

py::object to_record(const LawRate& rate) {
  return type("LawRate")(rate.stream_time.count(), rate.rate, rate.slope);
}

py::object to_record(const StepResult& result) {
  return type("StepResult")(result.consumed, result.published, result.missed);
}

py::object to_record(const std::optional<CurveProgress>& progress) {
  if (!progress) return py::none();
  return type("Progress")(progress->revision, progress->newest.count(),
                          progress->settled_until.count(), progress->is_finished,
                          progress->waypoints, progress->refused);
}

py::object to_record(const SnapshotSegment& segment, std::size_t dimensions) {
  const py::array coefficients = to_array(segment.coefficients);
  return type("Segment")(segment.left.count(), segment.right.count(),
                         member("SegmentKind", static_cast<std::uint8_t>(segment.kind)),
                         coefficients.attr("reshape")(segment.order, dimensions),
                         array_or_none(segment.waypoint), array_or_none(segment.acceleration_step),
                         segment.is_corner);
}

py::dict to_record(const MotionLimits& limits) {
  py::dict found;
  const std::array<std::pair<const char*, const std::vector<double>*>, 5> lists{
      {{"velocity", &limits.velocity},
       {"acceleration", &limits.acceleration},
       {"jerk", &limits.jerk},
       {"lower", &limits.lower},
       {"upper", &limits.upper}}};
  for (const auto& [name, values] : lists) {
    if (!values->empty()) found[name] = to_array(*values);
  }
  return found;
}

}  // namespace splinecast::python
