#include "apps/record/watch/settled_excesses.hpp"

#include <fmt/format.h>

#include <iterator>
#include <limits>
#include <utility>

#include "apps/record/format/json.hpp"
#include "core/limits/check.hpp"
#include "core/limits/limit_of.hpp"

namespace splinecast::apps::record {
namespace {

using Outcome = SettledExcess::Outcome;

core::SegmentPart part_of(const ipc::SegmentCopy& segment) noexcept {
  return {.order = segment.order,
          .coefficients = segment.coefficients,
          .dimensions = segment.coefficients.size() / static_cast<std::size_t>(segment.order),
          .from = 0,
          .to = to_seconds(segment.right - segment.left)};
}

}  // namespace

SettledExcesses::SettledExcesses(const core::WindowOptions& options, DimensionKinds kinds)
    : limits_(core::limits_at_rate(options.limits, options.max_rate)), kinds_(std::move(kinds)) {}

std::optional<SettledExcess> SettledExcesses::add(const LimitExcess& excess) {
  open_.emplace(excess.time, excess);
  if (open_.size() <= kMostOpen) return std::nullopt;
  const auto latest = std::prev(open_.end());
  const SettledExcess dropped{.excess = latest->second, .outcome = Outcome::unknown};
  open_.erase(latest);
  return dropped;
}

std::vector<SettledExcess> SettledExcesses::take(const ipc::SegmentCopy& segment) {
  std::vector<SettledExcess> settled;
  for (auto at = open_.begin(); at != open_.end() && at->first <= segment.right;) {
    const SettledExcess found = look_up(at->second, segment);
    // The largest acceleration is often at a knot: both segments have it, unless one is a stop.
    const bool may_be_in_next = found.outcome == Outcome::replaced && at->first == segment.right;
    if (may_be_in_next) {
      ++at;
      continue;
    }
    settled.push_back(found);
    at = open_.erase(at);
  }
  return settled;
}

std::vector<SettledExcess> SettledExcesses::finish() {
  std::vector<SettledExcess> settled;
  for (const auto& [time, excess] : open_) {
    settled.push_back({.excess = excess, .outcome = Outcome::replaced});
  }
  open_.clear();
  return settled;
}

SettledExcess SettledExcesses::look_up(const LimitExcess& excess,
                                       const ipc::SegmentCopy& segment) const {
  const core::SegmentPart part = part_of(segment);
  SettledExcess found{.excess = excess, .outcome = Outcome::unknown};
  if (excess.time < segment.left || excess.dimension >= part.dimensions) return found;
  const MotionLimits limits = only(excess.kind, excess.dimension);
  found.outcome = core::keeps_within(limits, &kinds_, part) ? Outcome::replaced : Outcome::executed;
  if (found.outcome == Outcome::replaced) return found;
  const Excess worst = core::worst_excess(limits, &kinds_, part);
  found.excess.time = segment.left + from_seconds(worst.u);
  found.excess.value = worst.value;
  found.excess.limit = worst.limit;
  return found;
}

/// The limits of one kind and one dimension.
MotionLimits SettledExcesses::only(LimitKind kind, std::size_t dimension) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  MotionLimits found;
  const auto copy = [dimension](const std::vector<double>& from, std::vector<double>& to,
                                double none) {
    if (from.empty()) return;
    to.assign(from.size(), none);
    to[dimension] = from[dimension];
  };
  if (kind == LimitKind::velocity) copy(limits_.velocity, found.velocity, 0);
  if (kind == LimitKind::acceleration) copy(limits_.acceleration, found.acceleration, 0);
  if (kind == LimitKind::jerk) copy(limits_.jerk, found.jerk, 0);
  if (kind == LimitKind::position) {
    copy(limits_.lower, found.lower, -kInfinity);
    copy(limits_.upper, found.upper, kInfinity);
  }
  return found;
}

std::string members_of(const SettledExcess& settled, const std::vector<std::string>& names) {
  const LimitExcess& excess = settled.excess;
  std::string text = fmt::format(R"("item":{},)", excess.item);
  if (settled.outcome != Outcome::unknown) {
    text += fmt::format(R"("executed":{},)", settled.outcome == Outcome::executed);
  }
  text += place_of(excess, names);
  if (settled.outcome == Outcome::executed) text += values_of(excess);
  return text;
}

}  // namespace splinecast::apps::record
