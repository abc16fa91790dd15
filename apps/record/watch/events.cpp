#include "apps/record/watch/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/record/format/json.hpp"

namespace splinecast::apps::record {
namespace {

constexpr std::array<std::string_view, kEventKinds> kNames{
    "attached",  "underrun", "deadline", "late",     "refusal",
    "takeover",  "limit",    "finished", "retired",  "lost",
    "following", "stopped",  "released", "returned", "limit_settled"};
constexpr std::array kTriggers{EventKind::underrun, EventKind::deadline, EventKind::late,
                               EventKind::refusal,  EventKind::takeover, EventKind::limit};

}  // namespace

std::string_view to_string(EventKind kind) noexcept {
  return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<EventKind> parse_trigger(std::string_view name) noexcept {
  const auto found =
      std::ranges::find(kTriggers, name, [](EventKind kind) { return to_string(kind); });
  return found != kTriggers.end() ? std::optional(*found) : std::nullopt;
}

std::string trigger_names() {
  std::string names;
  for (const EventKind kind : kTriggers) {
    names.append(names.empty() ? "" : ",").append(to_string(kind));
  }
  return names;
}

void add_event(Batch& batch, const EventNote& event, Time time, Time own_time,
               const std::string& members) {
  const std::string text =
      fmt::format(R"({{"time_ns":{},"event":"{}"{}{}{}}})", time.count(), to_string(event.kind),
                  event.is_old ? R"(,"old":true)" : "", members.empty() ? "" : ",", members);
  const auto bytes = std::as_bytes(std::span(text));
  batch.events.push_back(event);
  batch.add({.stream = event.stream,
             .kind = RecordKind::event,
             .number = static_cast<ipc::Word>(event.kind),
             .own_time = own_time,
             .bytes = Bytes(bytes.begin(), bytes.end())});
}

void add_loss(Batch& batch, std::uint32_t stream, const Loss& loss, Time time) {
  batch.add(
      {.stream = stream, .kind = RecordKind::loss, .own_time = batch.now, .bytes = encode(loss)});
  if (loss.all() == 0) return;
  add_event(
      batch, {.stream = stream, .kind = EventKind::lost}, time, batch.now,
      fmt::format(R"("reason":"{}","count":{},"items":{},"segments":{},"refusals":{},"others":{},)"
                  R"("first_item":{},"first_segment":{})",
                  to_string(loss.cause), loss.all(), loss.items.count, loss.segments.count,
                  loss.refusals, loss.others, loss.items.first, loss.segments.first));
}

std::string members_of(const LimitExcess& excess, const std::vector<std::string>& names) {
  return fmt::format(R"("item":{},"refused":{},)", excess.item, excess.is_refused) +
         place_of(excess, names) + values_of(excess);
}

std::string place_of(const LimitExcess& excess, const std::vector<std::string>& names) {
  const bool is_named = excess.dimension < names.size() && !names[excess.dimension].empty();
  return fmt::format(
      R"("limit_kind":"{}","dimension":{},"at_ns":{})", splinecast::to_string(excess.kind),
      json_text(is_named ? names[excess.dimension] : std::to_string(excess.dimension)),
      excess.time.count());
}

std::string values_of(const LimitExcess& excess) {
  std::string text = R"(,"value":)";
  append_number(text, excess.value);
  text += R"(,"limit":)";
  append_number(text, excess.limit);
  return text;
}

}  // namespace splinecast::apps::record
