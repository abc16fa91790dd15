#include "apps/tables/table_rows.hpp"

#include <fmt/format.h>

namespace splinecast::apps {

TableRows::TableRows(const WaypointTable& table)
    : table_(table), columns_{.names = table.names, .aliases = {}, .kinds = table.kinds} {}

bool TableRows::next(Row& row) {
  if (next_ == table_.size()) return false;
  const Waypoint waypoint = table_.waypoint(next_);
  row = {.number = table_.lines[next_],
         .time = waypoint.time,
         .position = waypoint.position,
         .velocity = waypoint.velocity,
         .acceleration = waypoint.acceleration};
  ++next_;
  return true;
}

std::string TableRows::where(std::size_t number) const {
  return table_.source ? table_.source->where(number) : fmt::format("{}:{}", table_.file, number);
}

double TableRows::fraction_read() const {
  return table_.size() == 0 ? 1 : static_cast<double>(next_) / static_cast<double>(table_.size());
}

}  // namespace splinecast::apps
