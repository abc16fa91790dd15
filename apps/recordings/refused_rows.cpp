#include "apps/recordings/refused_rows.hpp"

#include <algorithm>

#include "apps/process/messages.hpp"

namespace splinecast::apps {
namespace {

std::string_view to_string(RefusedBy by) {
  switch (by) {
    case RefusedBy::file:
      return "file";
    case RefusedBy::producer:
      return "producer";
    case RefusedBy::solver:
      return "solver";
  }
  return "unknown";
}

}  // namespace

nlohmann::ordered_json to_json(const LimitExcess& excess) {
  return {{"kind", to_string(excess.kind)},
          {"dimension", excess.dimension},
          {"time_ns", excess.time.count()},
          {"value", excess.value},
          {"limit", excess.limit}};
}

void RefusedRows::add(const RefusedRow& row, std::string_view message) {
  say(message);
  const auto same = [&](const Count& c) { return c.by == row.by && c.reason == row.reason; };
  const auto counted = std::ranges::find_if(counts_, same);
  if (counted == counts_.end()) {
    counts_.push_back({.by = row.by, .reason = row.reason, .count = 1});
  } else {
    ++counted->count;
  }
  if (rows_.size() < kListed) {
    rows_.push_back(row);
  } else {
    ++unlisted_;
  }
}

ipc::Word RefusedRows::count(RefusedBy by) const noexcept {
  ipc::Word sum = 0;
  for (const Count& c : counts_) sum += c.by == by ? c.count : 0;
  return sum;
}

ipc::Word RefusedRows::count(RefusedBy by, std::string_view reason) const noexcept {
  for (const Count& c : counts_) {
    if (c.by == by && c.reason == reason) return c.count;
  }
  return 0;
}

nlohmann::ordered_json RefusedRows::to_json(std::string_view row_name) const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const RefusedRow& row : rows_) {
    nlohmann::ordered_json json{
        {row_name, nullptr}, {"by", to_string(row.by)}, {"reason", row.reason}};
    if (row.number) json[std::string(row_name)] = *row.number;
    if (row.item) json["item"] = *row.item;
    if (row.loop) json["loop"] = *row.loop;
    if (row.excess) json["beyond"] = apps::to_json(*row.excess);
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace splinecast::apps
