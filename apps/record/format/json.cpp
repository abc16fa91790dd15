#include "apps/record/format/json.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"

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
    append(text, "{}", value);
  } else {
    text += "null";
  }
}

JsonMessages::JsonMessages(const ipc::RegionHeader& header) {
  for (const std::string& name : names_in_json(header)) keys_.push_back(json_text(name) + ":");
}

void JsonMessages::values(std::string_view name, std::span<const double> values) {
  if (values.empty()) return;
  append(text_, ",\"{}\":{{", name);
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

std::string_view JsonMessages::state(Time time, std::span<const double> position,
                                     std::span<const double> velocity,
                                     std::span<const double> acceleration) {
  text_.clear();
  append(text_, R"({{"time_ns":{})", time.count());
  values("position", position);
  values("velocity", velocity);
  values("acceleration", acceleration);
  text_ += '}';
  return text_;
}

std::string JsonMessages::schema(std::string_view title, std::string_view further) const {
  std::string each;
  for (const std::string& key : keys_) {
    if (!each.empty()) each += ',';
    each += key + R"({"type":"number"})";
  }
  std::string text =
      fmt::format(R"({{"title":"{}","type":"object","properties":{{{})", title, kTimeProperty);
  text += further;
  for (const std::string_view part : {"position", "velocity", "acceleration"}) {
    append(text, R"(,"{}":{{"type":"object","properties":{{{}}}}})", part, each);
  }
  return text + "}}";
}

std::string JsonMessages::waypoint_schema() const {
  return schema("splinecast.Waypoint",
                R"(,"kind":{"type":"string"},"item":{"type":"integer"},"old":{"type":"boolean"},)"
                R"("condition":{"type":"string"},"count":{"type":"integer"},)"
                R"("blend_ns":{"type":"integer"},"rate":{"type":"number"},)"
                R"("length_ns":{"type":"integer"},"commander":{"type":"integer"},)"
                R"("request":{"type":"integer"})");
}

std::string JsonMessages::state_schema() const { return schema("splinecast.State", ""); }

std::string JsonMessages::event_schema() {
  return fmt::format(
      R"({{"title":"splinecast.Event","type":"object","properties":{{{},)"
      R"("event":{{"type":"string"}},"text":{{"type":"string"}},"count":{{"type":"integer"}},)"
      R"("item":{{"type":"integer"}},"reason":{{"type":"string"}},"role":{{"type":"string"}},)"
      R"("pid":{{"type":"integer"}},"epoch":{{"type":"integer"}},)"
      R"("dimension":{{"type":"string"}},"limit_kind":{{"type":"string"}},)"
      R"("value":{{"type":"number"}},"limit":{{"type":"number"}},"refused":{{"type":"boolean"}}}}}})",
      kTimeProperty);
}

}  // namespace splinecast::apps::record
