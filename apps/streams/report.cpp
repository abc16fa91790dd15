#include "apps/streams/report.hpp"
#include "apps/output/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "apps/recordings/refused_rows.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

std::string clock_name(const ipc::RegionHeader& header) {
  if (ipc::stream_clock(header) == StreamClock::law) return "law";
  return ipc::stream_clock(header) == StreamClock::monotonic ? "live" : "recorded";
}

ordered_json kinds_json(const ipc::RegionHeader& header) {
  ordered_json kinds = ordered_json::array();
  for (const Dimension& dimension : ipc::dimensions_of(header)) {
    kinds.push_back(to_string(dimension));
  }
  return kinds;
}

/// The fields that both headers have; from the producer's header if it exists.
ordered_json stream_json(const ipc::RegionHeader& header) {
  ordered_json json = {
      {"stream_id", std::to_string(header.stream_id)},  // 64 bits do not fit into a JSON number
      {"dimensions", header.dimensions},
      {"names", ipc::dimension_names(header)},
      {"kinds", kinds_json(header)},
      {"clock", clock_name(header)},
      {"start", to_string(ipc::start_condition(header))},
  };
  json.update(intervals_to_json(header));
  if (header.is_law != 0) {
    json["time_law"] = {{"origin_ns", header.law_origin}, {"largest_rate", header.largest_rate}};
  }
  if (header.law_id != 0) {
    json["law"] = ipc::text_of(header.law);
    json["law_id"] = std::to_string(header.law_id);
  }
  return json;
}

ordered_json producer_json(const ipc::StreamInfo& info) {
  ordered_json refused = ordered_json::object();
  for (std::size_t i = 1; i < info.refused_by_producer.size(); ++i) {
    refused[std::string(to_string(static_cast<AppendStatus>(i)))] = info.refused_by_producer[i];
  }
  return {
      {"alive", info.producer_alive},
      {"pid", info.waypoints->owner_pid},
      {"epoch", info.waypoints->epoch},
      {"ring_capacity", info.waypoints->capacity},
      {"region_bytes", info.waypoints->region_bytes},
      {"appended", info.appended},
      {"refused", refused},
  };
}

ordered_json refusals_json(const ipc::StreamInfo& info) {
  ordered_json list = ordered_json::array();
  for (const ipc::RefusalRecord& refusal : info.refusals) {
    list.push_back({{"item", refusal.item}, {"reason", to_string(refusal.reason)}});
  }
  return list;
}

ordered_json excess_json(const LimitExcess& excess) {
  ordered_json json{{"item", excess.item}, {"refused", excess.is_refused}};
  json.update(to_json(excess));
  return json;
}

ordered_json excesses_json(const ipc::StreamInfo& info) {
  ordered_json list = ordered_json::array();
  for (const LimitExcess& excess : info.excesses) list.push_back(excess_json(excess));
  return list;
}

/// The stoppers of the stream, by its board.
ordered_json stoppers_json(const ipc::StreamInfo& info) {
  ordered_json list = ordered_json::array();
  for (const ipc::StopperEntry& stopper : info.stoppers) {
    list.push_back({{"name", stopper.name}, {"request", stopper.number}, {"holds", stopper.holds}});
  }
  return list;
}

/// Whether the curve follows its waypoints; null unless it must keep its limits.
ordered_json following_json(const ipc::StreamInfo& info) {
  const ipc::Summary& summary = info.summary;
  if (ipc::beyond(*info.spline) != Beyond::enter) return nullptr;
  const bool is_unmet = summary.unmet_since < Time::max();
  return {
      {"state", ipc::to_string(summary.following())},
      {"unmet_since_ns", is_unmet ? ordered_json(summary.unmet_since.count()) : ordered_json()}};
}

/// A value per dimension, null for none; an empty list if no dimension has a limit of the kind.
ordered_json limits_json(const ipc::RegionHeader& header) {
  const MotionLimits limits = ipc::motion_limits(header);
  const auto list = [](const std::vector<double>& values) {
    ordered_json out = ordered_json::array();
    for (const double value : values) {
      out.push_back(value == 0 ? ordered_json() : ordered_json(value));
    }
    return out;
  };
  return {
      {"velocity", list(limits.velocity)},
      {"acceleration", list(limits.acceleration)},
      {"jerk", list(limits.jerk)},
      {"lower", limits.lower},  // infinite values become null
      {"upper", limits.upper},
      {"beyond", to_string(ipc::beyond(header))},
  };
}

/// The limits that the motion of a live stream shows: entries keep them if no limits are given.
ordered_json shown_json(const ipc::StreamInfo& info) {
  if (!info.shown) return nullptr;
  return {{"velocity", info.shown->velocity}, {"acceleration", info.shown->acceleration}};
}

/// Time from now to the newest knot; null for a recorded stream, and without a knot.
ordered_json depth(const ipc::StreamInfo& info) {
  if (clock_name(*info.spline) == "recorded" || info.summary.newest == 0) return nullptr;
  const Time left = info.summary.newest_time - MonotonicClock().now();
  return std::max(left, Time::zero()).count();
}

/// Durations of the solver's steps, from reading the clock to the commit: pairs of a time t in ns
/// and the number of steps that took t to 2t, without pairs whose number is 0.
ordered_json step_times_json(const ipc::StreamInfo& info) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < info.step_times.size(); ++i) {
    if (info.step_times[i] > 0) list.push_back({std::uint64_t{1} << i, info.step_times[i]});
  }
  return list;
}

/// The number of items that the solver has refused, by reason.
ordered_json refused_json(const ipc::Summary& summary) {
  ordered_json refused = ordered_json::object();
  for (std::size_t i = 1; i < kRefusals; ++i) {
    refused[std::string(to_string(static_cast<Refusal>(i)))] = summary.reasons[i];
  }
  return refused;
}

/// The solver of the stream, and its options.
ordered_json solving_json(const ipc::StreamInfo& info) {
  const ipc::RegionHeader& header = *info.spline;
  ordered_json found{{"alive", info.solver_alive},
                     {"pid", header.owner_pid},
                     {"epoch", header.epoch},
                     {"method", ipc::window_options(header).interpolant.method->name}};
  found.update(curve_to_json(header));
  found.erase("capacity");
  found.erase("beyond");  // among the limits
  found.update(ordered_json{{"board_capacity", header.capacity},
                            {"region_bytes", header.region_bytes},
                            {"max_acceleration", ipc::motion_limits(header).acceleration},
                            {"limits", limits_json(header)},
                            {"shown", shown_json(info)}});
  return found;
}

ordered_json solver_json(const ipc::StreamInfo& info) {
  const ipc::Summary& summary = info.summary;
  const bool has_settled = summary.settled_until > -kLatestTime;
  const bool has_low_water = summary.low_water < Time::max();
  ordered_json found = solving_json(info);
  found.update(ordered_json{
      {"revision", summary.revision},
      {"consumed", summary.consumed},
      {"interpolated", summary.interpolated()},
      {"passed_over", summary.passed_over},
      {"refused", summary.refused},
      {"refused_by_reason", refused_json(summary)},
      {"refusals", refusals_json(info)},
      {"exceeding", summary.exceeding},
      {"excesses", excesses_json(info)},
      {"worst_excess", info.worst_excess ? excess_json(*info.worst_excess) : ordered_json()},
      {"following", following_json(info)},
      {"stoppers", stoppers_json(info)},
      {"first_segment", summary.first},
      {"newest_segment", summary.newest},
      {"settled_until_ns",
       has_settled ? ordered_json(summary.settled_until.count()) : ordered_json()},
      {"newest_knot_ns", summary.newest_time.count()},
      {"committed_ns", summary.committed.count()},
      {"withdrawn", summary.all_withdrawn()},
      {"controls", summary.controls},
      {"depth_ns", depth(info)},
      {"low_water_ns", has_low_water ? ordered_json(summary.low_water.count()) : ordered_json()},
      {"starved", summary.starved},
      {"underruns", summary.underruns},
      {"deadline_misses", summary.deadline_misses},
      {"late_commits", summary.late_commits},
      {"finished", summary.finished},
      {"end", end_json(summary)},
      {"step_times_ns", step_times_json(info)},
  });
  return found;
}

}  // namespace

std::string pretty(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string state_of(const ipc::StreamInfo& info) {
  if (!info.waypoints) return info.solver_alive ? "waiting for a producer" : "stale";
  if (!info.spline || info.spline->stream_id != info.waypoints->stream_id) {
    return "waiting for a solver";
  }
  if (info.summary.finished) return "finished";
  if (info.producer_alive && info.solver_alive) return "running";
  return info.producer_alive || info.solver_alive ? "one writer gone" : "both writers gone";
}

ordered_json to_json(const ipc::StreamInfo& info) {
  ordered_json json{{"stream", info.stream}, {"state", state_of(info)}};
  const auto& header = info.waypoints ? info.waypoints : info.spline;
  if (header) json.update(stream_json(*header));
  json["producer"] = info.waypoints ? producer_json(info) : ordered_json(nullptr);
  json["solver"] = info.spline ? solver_json(info) : ordered_json(nullptr);
  return json;
}

std::string_view to_string(ipc::EndKind kind) {
  constexpr std::array<std::string_view, ipc::kEndKinds> kNames{
      "", "as requested", "slowed", "entered", "stopped", "ended in the stop"};
  return kNames.at(static_cast<std::size_t>(kind));
}

ordered_json end_json(const ipc::Summary& summary) {
  if (summary.ending() == ipc::EndKind::none) return nullptr;
  return {{"kind", to_string(summary.ending())},
          {"item", summary.end_item},
          {"lateness_ns", summary.end_lateness.count()}};
}

std::string end_in_words(ipc::EndKind kind, Time lateness) {
  const std::string late =
      fmt::format("rests at the last waypoint {:.3f} s late", to_seconds(lateness));
  switch (kind) {
    case ipc::EndKind::slowed:
      return "slowed down on its path and " + late;
    case ipc::EndKind::entered:
      return lateness > Time::zero() ? late : "left the path to rest at the last waypoint";
    case ipc::EndKind::stopped:
      return "ended in the stop after the last waypoint";
    case ipc::EndKind::in_stop:
      return "ended in the stop";
    default:
      return "";
  }
}

std::string end_in_words(const ipc::Summary& summary) {
  const std::string text = end_in_words(summary.ending(), summary.end_lateness);
  return text.empty() ? text : "; " + text;
}

std::string following_in_words(const ipc::Summary& summary) {
  switch (summary.following()) {
    case ipc::Following::meets_none:
      return fmt::format(
          "no waypoint met for {:.1f} s: within the limits the curve cannot follow them; noisy "
          "ones "
          "need --method smoothing",
          to_seconds(summary.newest_time - summary.unmet_since));
    case ipc::Following::cannot_follow:
      return "cannot follow its waypoints: it comes to rest, and refuses them until an entry from "
             "rest leads to one";
    default:
      return "meets its waypoints again";
  }
}

std::string passed_over_in_words(ipc::Word count) {
  return count == 0 ? "" : fmt::format(", {} passed over", count);
}

}  // namespace splinecast::apps
