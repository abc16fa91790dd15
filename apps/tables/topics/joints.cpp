#include "apps/tables/topics/joints.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

JointNames::JointNames(const std::vector<std::string_view>& first, const TableOptions& options) {
  columns_.names = chosen_names(options);
  for (const std::string& chosen : columns_.names) {
    if (std::ranges::find(first, chosen) != first.end()) continue;
    throw InputError(fmt::format("there is no joint '{}' among {}", shown(chosen),
                                 shown(fmt::format("{}", fmt::join(first, ", ")))));
  }
  if (columns_.names.empty()) columns_.names.assign(first.begin(), first.end());
  if (columns_.names.empty()) throw MessageError("it has no joints");
  if (columns_.names.size() > kMaxDimensions) {
    throw InputError(fmt::format("{} joints; the maximum is {}: choose joints with --joints",
                                 columns_.names.size(), kMaxDimensions));
  }
}

void JointNames::match(const std::vector<std::string_view>& names) {
  if (std::ranges::equal(names, matched_) && !at_.empty()) return;
  matched_.clear();
  at_.clear();
  for (const std::string& column : columns_.names) {
    const auto found = std::ranges::find(names, column);
    if (found == names.end()) {
      at_.clear();
      throw MessageError(fmt::format("there is no joint '{}'", shown(column)));
    }
    at_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  matched_.assign(names.begin(), names.end());
}

std::span<const double> JointNames::ordered(std::span<const double> from,
                                            std::vector<double>& values) const {
  values.clear();
  if (from.empty()) return {};
  for (const std::size_t at : at_) values.push_back(from[at]);
  return values;
}

}  // namespace splinecast::apps
