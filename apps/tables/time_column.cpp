#include "apps/tables/time_column.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace splinecast::apps {

std::optional<TimeUnit> unit_of_time_column(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string_view rest = lower;
  if (rest == "%time") return TimeUnit::nanoseconds;  // `rostopic echo -p`
  for (const std::string_view base :
       {"timestamp", "time", "__time", "stamp", "seconds", "secs", "sec", "t"}) {
    if (!rest.starts_with(base)) continue;
    rest.remove_prefix(base.size());
    if (rest.empty()) return TimeUnit::seconds;
    if (rest.front() == '_') return parse_time_unit(rest.substr(1));
    rest = trimmed(rest);
    const bool bracketed = (rest.starts_with('[') && rest.ends_with(']')) ||
                           (rest.starts_with('(') && rest.ends_with(')'));
    return bracketed ? parse_time_unit(rest.substr(1, rest.size() - 2)) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace splinecast::apps
