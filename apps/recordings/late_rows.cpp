#include "apps/recordings/late_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace splinecast::apps {
namespace {

constexpr std::array kPolicies{LatePolicy::refuse, LatePolicy::pass, LatePolicy::shift};

/// The kinds of late rows, with their names in reports.
constexpr std::array<std::pair<const char*, ipc::Word LateRows::*>, 3> kLateKinds{
    {{"duplicate", &LateRows::duplicate},
     {"out of order", &LateRows::out_of_order},
     {"past", &LateRows::past}}};

}  // namespace

std::optional<LatePolicy> parse_late_policy(std::string_view text) noexcept {
  for (const LatePolicy policy : kPolicies) {
    if (text == to_string(policy)) return policy;
  }
  return std::nullopt;
}

std::string_view to_string(LatePolicy policy) noexcept {
  switch (policy) {
    case LatePolicy::refuse:
      return "refuse";
    case LatePolicy::pass:
      return "pass";
    case LatePolicy::shift:
      return "shift";
  }
  return "unknown";
}

void LateRows::count(ipc::Word LateRows::*kind, Time lateness) noexcept {
  ++(this->*kind);
  largest = std::max(largest, lateness);
}

void LateRows::shift(Time by) noexcept {
  ++shifts;
  shifted = saturated_sum(shifted, by);
}

LateRows& LateRows::operator+=(const LateRows& other) noexcept {
  for (const auto& [name, kind] : kLateKinds) this->*kind += other.*kind;
  left_out += other.left_out;
  shifts += other.shifts;
  shifted = saturated_sum(shifted, other.shifted);
  largest = std::max(largest, other.largest);
  return *this;
}

nlohmann::ordered_json to_json(const LateRows& late, LatePolicy policy) {
  nlohmann::ordered_json kinds;
  for (const auto& [name, kind] : kLateKinds) kinds[name] = late.*kind;
  return {{"policy", to_string(policy)},        {"by_kind", kinds},
          {"left_out", late.left_out},          {"shifts", late.shifts},
          {"shifted_ns", late.shifted.count()}, {"largest_ns", late.largest.count()}};
}

std::string in_words(const LateRows& late) {
  ipc::Word rows = 0;
  std::string kinds;
  for (const auto& [name, kind] : kLateKinds) {
    if (late.*kind == 0) continue;
    rows += late.*kind;
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", late.*kind, name);
  }
  if (rows == 0) return {};
  std::string text =
      fmt::format("{} late ({}), at most {:.6g} s", rows, kinds, to_seconds(late.largest));
  if (late.left_out > 0) text += fmt::format("; {} left out", late.left_out);
  if (late.shifts > 0) {
    text +=
        fmt::format("; shifted {} times, {:.6g} s in total", late.shifts, to_seconds(late.shifted));
  }
  return text;
}

}  // namespace splinecast::apps
