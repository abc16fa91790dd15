#include <array>
#include <cstddef>

#include "ipc/arguments/excess.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/c/roles.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

/// Where a program wants the peaks of a motion.
struct PeakOutputs {
  Outputs velocity;
  Outputs acceleration;
  Outputs jerk;

  void put(const MotionPeaks& peaks) const {
    copy(peaks.velocity, velocity);
    copy(peaks.acceleration, acceleration);
    copy(peaks.jerk, jerk);
  }
  static void copy(const std::vector<double>& from, const Outputs& to) {
    for (std::size_t d = 0; d < to.size(); ++d) to[d] = from[d];
  }
};

/// Writes a preview to its struct, except its peaks.
void fill(const ReplacePreview& found, splinecast_preview& out) {
  out.status = static_cast<int>(found.status);
  out.is_known = found.is_known ? 1 : 0;
  if (!found.is_known) return;
  out.begin = found.begin.count();
  out.duration = found.duration.count();
  out.waypoint = found.waypoint ? static_cast<int64_t>(*found.waypoint) : -1;
  out.passed_over = found.passed_over;
  out.enters = found.enters ? 1 : 0;
  out.from_rest = found.from_rest ? 1 : 0;
  out.worst = excess_of(found.worst);
}

}  // namespace

extern "C" int splinecast_producer_preview_replace(splinecast_producer* producer, int64_t t,
                                                   const splinecast_waypoints* waypoints,
                                                   int64_t blend, splinecast_preview* out) {
  return guarded([&] {
    splinecast_producer& own = require_producer(producer);
    splinecast_preview filled = read_struct(out, SPLINECAST_PREVIEW_INIT, "out");
    const std::size_t size = own.dimensions;
    const PeakOutputs entry{
        optional_output(filled.entry_velocity, size, "out->entry_velocity"),
        optional_output(filled.entry_acceleration, size, "out->entry_acceleration"),
        optional_output(filled.entry_jerk, size, "out->entry_jerk")};
    const PeakOutputs motion{
        optional_output(filled.motion_velocity, size, "out->motion_velocity"),
        optional_output(filled.motion_acceleration, size, "out->motion_acceleration"),
        optional_output(filled.motion_jerk, size, "out->motion_jerk")};
    const auto list = own.waypoints.replacement(waypoints, size);
    own.preview.status = AppendStatus::too_many;
    own.preview.is_known = false;
    if (list) own.producer.preview_replace(Time(t), *list, {.blend = Time(blend)}, own.preview);
    fill(own.preview, filled);
    write_struct(filled, out);
    if (own.preview.is_known) {
      entry.put(own.preview.entry);
      motion.put(own.preview.motion);
    }
    return 0;
  });
}
