#include "apps/files/unit_of_name.hpp"

#include "apps/files/numbers.hpp"

namespace splinecast::apps {

std::pair<std::string, std::string> name_and_unit(const std::string& column) {
  for (const auto& brackets : {"[]", "()"}) {
    const std::size_t open = column.rfind(brackets[0]);
    if (open == std::string::npos || open == 0 || column.back() != brackets[1]) continue;
    const std::string unit(without_blanks(column.substr(open + 1, column.size() - open - 2)));
    // In p[0], v[1], … the brackets hold an index.
    if (unit.empty() || parse_count(unit)) continue;
    return {std::string(without_blanks(column.substr(0, open))), unit};
  }
  return {column, ""};
}

}  // namespace splinecast::apps
