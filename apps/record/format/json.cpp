#include "apps/record/format/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/verification/difference.hpp"

namespace splinecast::apps::record {
namespace {

constexpr std::string_view kTimeProperty =
    R"("time_ns":{"type":"integer","description":"time of the stream, ns"})";

std::string_view name_of(ipc::ItemKind kind) noexcept {
  constexpr std::array<std::string_view, 6> kNames{"unknown",     "waypoint", "replace",
                                                   "start_state", "finish",   "rate"};
  const auto i = static_cast<std::size_t>(kind);
  return i < kNames.size() ? kNames.at(i) : kNames.front();
}

template <typename... T>
void append(std::string& text, fmt::format_string<T...> format, T&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<T>(values)...);
}

}  // namespace

std::string json_text(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void append_number(std::string& text, double value) {
  if (value == 0) {
    text += std::signbit(value) ? "-0.0" : "0";
  } else if (std::isfinite(value)) {
    std::array<char, 32> digits{};
    const char* const end = std::to_chars(digits.begin(), digits.end(), value).ptr;
    text.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
  } else {
    text += "null";
  }
}

JsonMessages::JsonMessages(const ipc::RegionHeader& header) : units_(ipc::dimension_units(header)) {
  for (const std::string& name : names_in_json(header)) keys_.push_back(json_text(name) + ":");
}

void JsonMessages::values(std::string_view name, std::span<const double> values) {
  if (values.empty()) return;
  text_.append(",\"").append(name).append("\":{");
  for (std::size_t d = 0; d < values.size() && d < keys_.size(); ++d) {
    if (d > 0) text_ += ',';
    text_ += keys_[d];
    append_number(text_, values[d]);
  }
  text_ += '}';
}

std::string_view JsonMessages::waypoint(const NumberedItem& numbered) {
  const ipc::RingItem& item = numbered.item;
  text_.clear();
  append(text_, R"({{"time_ns":{},"kind":"{}","item":{})", item.time.count(), name_of(item.kind),
         numbered.number);
  if (numbered.is_old) text_ += R"(,"old":true)";
  const Waypoint given = values_of(item);
  if (item.kind == ipc::ItemKind::finish) {
    append(text_, R"(,"condition":"{}")", to_string(condition_of(item)));
  } else if (item.kind == ipc::ItemKind::rate) {
    const auto piece = ipc::piece_of(given).value_or(ipc::RateItem{});
    append(text_, R"(,"rate":{},"length_ns":{},"commander":{},"request":{},"count":{})",
           piece.end_rate, piece.length.count(), item.commander, item.request(), item.count);
  } else {
    values("position", given.position);
    values("velocity", given.velocity);
    values("acceleration", given.acceleration);
  }
  if (item.kind == ipc::ItemKind::replace) {
    append(text_, R"(,"count":{},"blend_ns":{})", item.count, item.blend.count());
  }
  text_ += '}';
  return text_;
}

std::string_view JsonMessages::state(Time time, SegmentKind kind, const State& state) {
  text_.clear();
  append(text_, R"({{"time_ns":{},"kind":"{}")", time.count(), ipc::in_words(kind));
  values("position", state.position());
  values("velocity", state.velocity());
  values("acceleration", state.acceleration());
  text_ += '}';
  return text_;
}

std::string JsonMessages::schema(std::string_view title, std::string_view further) const {
  std::string text =
      fmt::format(R"({{"title":"{}","type":"object","properties":{{{})", title, kTimeProperty);
  text += further;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kParts{
      {{"position", ""}, {"velocity", "/s"}, {"acceleration", "/s²"}}};
  for (const auto& [part, per_time] : kParts) {
    append(text, R"(,"{}":{{"type":"object","properties":{{)", part);
    for (std::size_t d = 0; d < keys_.size(); ++d) {
      const std::string unit = units_[d].empty() ? "" : units_[d] + std::string(per_time);
      append(text, R"({}{}{{"type":"number","description":{}}})", d > 0 ? "," : "", keys_[d],
             json_text(unit.empty() ? "no unit is known" : unit));
    }
    text += "}}";
  }
  return text + "}}";
}

std::string JsonMessages::waypoint_schema() const {
  return schema(
      "splinecast.Waypoint",
      R"(,"kind":{"type":"string"},"item":{"type":"integer"},"old":{"type":"boolean"},)"
      R"("condition":{"type":"string"},"count":{"type":"integer"},)"
      R"("blend_ns":{"type":"integer","description":"ns"},"rate":{"type":"number"},)"
      R"("length_ns":{"type":"integer","description":"ns"},"commander":{"type":"integer"},)"
      R"("request":{"type":"integer"})");
}

std::string JsonMessages::state_schema() const {
  return schema("splinecast.State",
                R"(,"kind":{"type":"string","description":"of the segment of the curve",)"
                R"("enum":["spline","entry","stop","hold","slowed"]})");
}

std::string JsonMessages::event_schema() {
  std::string text =
      fmt::format(R"({{"title":"splinecast.Event","type":"object","properties":{{{},)"
                  R"("event":{{"type":"string"}})",
                  kTimeProperty);
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes{{
      {"string", "reason role dimension limit_kind state stopper"},
      {"integer", "count item pid epoch request missed"},
      {"integer", "items segments refusals others first_item first_segment"},
      {"integer:time of the stream, ns", "at_ns"},
      {"number:in the unit of the dimension, per s, s² or s³ by limit_kind", "value limit"},
      {"integer:ns", "away_ns"},
      {"boolean", "refused executed"},
      {"boolean:it occurred before the recorder attached", "old"},
      {"string:of earlier versions", "text"},
  }};
  for (const auto& [type, names] : kTypes) {
    const auto colon = type.find(':');
    const std::string_view comment =
        colon == std::string_view::npos ? std::string_view() : type.substr(colon + 1);
    for (std::size_t at = 0; at < names.size();) {
      const std::size_t end = std::min(names.find(' ', at), names.size());
      append(text, R"(,"{}":{{"type":"{}")", names.substr(at, end - at), type.substr(0, colon));
      if (!comment.empty()) append(text, R"(,"description":"{}")", comment);
      text += '}';
      at = end + 1;
    }
  }
  return text + "}}";
}

}  // namespace splinecast::apps::record
