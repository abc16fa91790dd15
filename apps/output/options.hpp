#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>

#include "ipc/layout/options.hpp"

/// The options of a stream and of a curve as fields of JSON: by their keys, times in ns with `_ns`,
/// and words as text. The largest rate is one of the time law, and not among them.
namespace splinecast::apps {

template <typename Row>
[[nodiscard]] std::string json_key(const Row& row) {
  constexpr bool kIsTime = std::is_same_v<typename Row::Value, Time>;
  return std::string(row.key) + (kIsTime ? "_ns" : "");
}

/// Calls `visit` with the row of each option that is a field.
template <typename Visit>
void for_each_field(const Visit& visit) {
  ipc::for_each_option([&](const auto& row) {
    if constexpr (!ipc::kIsOfLaw<decltype(row)>) visit(row);
  });
}

/// Calls `visit` with the rows of the intervals that a stream allows.
template <typename Visit>
void for_each_interval(const Visit& visit) {
  visit(ipc::stream_option<&ipc::min_interval_of>());
  visit(ipc::stream_option<&ipc::max_interval_of>());
}

template <typename Row>
[[nodiscard]] nlohmann::ordered_json json_value(const Row& row, const ipc::RegionHeader& header) {
  const auto value = ipc::value_in(row, header);
  using Value = typename Row::Value;
  if constexpr (std::is_same_v<Value, Time>) {
    return value.count();
  } else if constexpr (std::is_enum_v<Value>) {
    return to_string(value);
  } else {
    return value;
  }
}

/// The options of a stream in a header of one of its regions, except the capacity.
[[nodiscard]] inline nlohmann::ordered_json intervals_to_json(const ipc::RegionHeader& header) {
  nlohmann::ordered_json fields;
  for_each_interval([&](const auto& row) { fields[json_key(row)] = json_value(row, header); });
  return fields;
}

/// The options of a curve in the header of its board.
[[nodiscard]] inline nlohmann::ordered_json curve_to_json(const ipc::RegionHeader& header) {
  nlohmann::ordered_json fields;
  for_each_field([&](const auto& row) { fields[json_key(row)] = json_value(row, header); });
  return fields;
}

}  // namespace splinecast::apps
