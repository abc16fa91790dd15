#include "ipc/roles/inspect.hpp"

#include <algorithm>
#include <utility>

#include "ipc/board/reader.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/owned/stoppers.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/solve/shown_motion.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

void inspect_waypoints(StreamInfo& info, const Trust& trust) {
  const auto [region, header, layout] = open_ring(info.stream, false, trust);
  info.waypoints = header;
  const WaypointRingReader ring(region.bytes(), layout);
  info.appended = ring.written();
  for (std::size_t i = 0; i < info.refused_by_producer.size(); ++i) {
    info.refused_by_producer[i] = ring.refused(static_cast<AppendStatus>(i));
  }
}

void inspect_spline(StreamInfo& info, const Trust& trust) {
  const auto [region, header, layout] = open_board(info.stream, false, trust);
  info.spline = header;
  const KnotBoardReader board(region.bytes(), layout);
  const auto law = law_of(header, trust);
  const Time final_until = law ? law->final_until(MonotonicClock().now()) : Time::max();
  (void)board.copy_newest_summary(info.summary);
  info.summary.settled_until = std::min(info.summary.settled_until, final_until);
  info.step_times = board.step_times();
  if (live_options(header)) {
    ShownMotion shown(board);
    shown.restore(board, info.summary, Time::max());
    shown.look(window_options(header).stop_length);
    info.shown = shown.limits();
  }
  info.refusals.resize(kRefusalsKept);
  info.refusals.resize(board.copy_refusals(info.summary, 0, info.refusals));
  const Word excesses = info.summary.exceeding;
  for (Word i = excesses - std::min<Word>(excesses, kExcessesKept); i < excesses; ++i) {
    if (const auto excess = board.excess(info.summary, i)) info.excesses.push_back(*excess);
  }
  info.worst_excess = board.worst_excess();
  info.stoppers = stoppers_of(board);
}

}  // namespace

StreamInfo inspect(const std::string& stream, const Trust& trust) {
  StreamInfo info;
  info.stream = stream;
  const bool has_waypoints = region_exists(stream, RegionKind::waypoints);
  const bool has_spline = region_exists(stream, RegionKind::spline);
  if (!has_waypoints && !has_spline) {
    throw NoSuchStream("there is no stream '" + stream + "'");
  }
  info.producer_alive = owner_lives(stream, RegionKind::waypoints);
  info.solver_alive = owner_lives(stream, RegionKind::spline);
  if (has_waypoints) inspect_waypoints(info, trust);
  if (has_spline) inspect_spline(info, trust);
  return info;
}

}  // namespace splinecast::ipc
