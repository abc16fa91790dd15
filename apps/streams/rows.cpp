#include "apps/streams/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/recordings/advice.hpp"
#include "apps/streams/report.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {
namespace {

std::vector<std::string> names_with_units(const ipc::RegionHeader& header) {
  std::vector<std::string> names = ipc::dimension_names(header);
  const std::vector<std::string> units = ipc::dimension_units(header);
  for (std::size_t d = 0; d < names.size(); ++d) {
    if (!units[d].empty()) names[d] += fmt::format(" [{}]", units[d]);
  }
  return names;
}

/// Removes the rows that a replacement from time t withdraws.
void withdraw_from(WaypointTable& table, Time t) {
  while (!table.times.empty() && table.times.back() > t) {
    table.times.pop_back();
    table.lines.pop_back();
  }
  table.positions.resize(table.size() * table.dimensions());
}

void take_item(const ipc::RingItem& item, ipc::Word number, WaypointTable& table) {
  if (item.kind == ipc::ItemKind::replace) withdraw_from(table, item.time);
  if (item.kind != ipc::ItemKind::waypoint) return;
  const Waypoint waypoint = item.waypoint();
  // Producers write only valid items, but a region can hold any bytes.
  const bool follows = table.times.empty() || waypoint.time > table.times.back();
  if (!follows || !is_time_in_range(waypoint.time) || !ipc::is_finite(waypoint)) return;
  table.times.push_back(waypoint.time);
  table.lines.push_back(number);
  table.positions.insert(table.positions.end(), waypoint.position.begin(), waypoint.position.end());
}

}  // namespace

WaypointTable read_stream_rows(const std::string& stream, const Trust& trust) {
  const auto [region, header, layout] = ipc::open_ring(stream, false, trust);
  const ipc::WaypointRingReader ring(region.bytes(), layout);
  WaypointTable table;
  table.file = fmt::format("stream '{}'", stream);
  table.names = names_with_units(header);
  table.kinds = ipc::dimensions_of(header);
  ipc::RingItem item(header.dimensions);
  const ipc::Word end = ring.written();
  for (ipc::Word i = end - std::min<ipc::Word>(end, ring.capacity()); i < end; ++i) {
    if (ring.observe(i, item)) take_item(item, i, table);
  }
  return table;
}

std::string depth_warning(const ipc::StreamInfo& info, const Trust& trust) {
  const bool is_measured = info.summary.low_water < Time::max() && state_of(info) == "running";
  const auto live = is_measured ? ipc::live_options(*info.spline) : std::nullopt;
  if (!live) return {};
  WaypointTable table;
  try {
    table = read_stream_rows(info.stream, trust);
  } catch (const StreamError&) {
    return {};  // the stream has been removed meanwhile
  }
  if (table.size() < 2) return {};
  const Time interval = measure_intervals(table.times).median;
  const Time needed =
      depth_needed(interval, {.settle = info.spline->settle, .settle_ahead = live->settle_ahead});
  // The depth is least just before a waypoint is consumed: one interval less than `needed`. Another
  // half interval is allowed for jitter.
  const Time usual = needed - interval;
  if (info.summary.low_water >= usual - interval / 2) return {};
  return fmt::format(
      "least depth {:.6g} ms: settle lag K = {} needs {:.6g} ms with one waypoint every {:.6g} ms; "
      "increase the lead",
      to_seconds(info.summary.low_water) * 1e3, info.spline->settle, to_seconds(usual) * 1e3,
      to_seconds(interval) * 1e3);
}

}  // namespace splinecast::apps
