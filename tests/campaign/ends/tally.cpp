#include "tests/campaign/ends/tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>

#include "apps/process/messages.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"

namespace splinecast::campaign::ends {
namespace {

constexpr std::array<std::string_view, kRules> kViolations{
    "curves that do not end at rest",
    "requested ends that do not rest",
    "settled pieces changed",
    "steps of position or velocity",
    "stops beyond a limit",
    "stops that speed up",
    "stops beyond a bound and not counted",
    "rotations that stop beyond a limit",
    "stops of 10⁶ s",
    "stops after an entry beyond a limit",
    "entries beyond a limit and their begin",
    "entries that begin beyond a limit of acceleration and stay there",
    "entries beyond a bound",
    "entries of a replacement beyond a bound, as far as a stop from its begin",
    "entries beyond the motion shown",
    "ends beyond a limit that the path keeps",
    "ends beyond a bound that the path keeps",
    "ends beyond the motion shown",
    "entries to the last waypoint that leave the range of the path",
    "splines beyond a limit without an excess counted",
    "excesses in the settled past",
    "stops and entries beyond a limit at the rate of the law",
    "curves that do not come to rest in time",
    "ends by an entry that takes long",
    "summaries whose counters do not add up",
    "waypoints neither interpolated nor passed over",
    "waypoints at the end of an entry that count as passed over",
    "ends as requested away from the last waypoint",
    "ends of another kind than reported",
    "samples that differ from the published curve",
    "finishes without an end",
    "slowed ends away from their path",
};

constexpr std::array<std::string_view, kEvents> kEventNames{
    "revisions",
    "takeovers",
    "takeovers between finish and end",
    "takeovers of a torn publication",
    "entries",
    "stops published",
    "stops that pass a bound",
    "waypoints beyond a limit",
    "waypoints refused",
    "searches for an end over several steps",
    "ends by an entry from rest",
    "ends in the step of the finish",
    "ends with the path outside a bound",
    "ends while a law holds",
    "starvations",
    "waypoints accepted",
    "waypoints passed over",
    "items withdrawn"};
constexpr std::array<std::string_view, ipc::kEndKinds> kEndNames{
    "none", "as requested", "slowed", "entered", "stopped", "in the stop"};
constexpr std::array<std::string_view, kLimitClasses> kLimitNames{"no", "generous", "tight"};
constexpr std::array<std::string_view, 8> kConditionNames{
    "natural", "clamped", "halt", "velocity", "acceleration", "not-a-knot", "periodic", "own"};
constexpr std::array<std::string_view, kDimensionKinds> kKindNames{"linear", "periodic",
                                                                   "quaternion", "quaternion-wxyz"};

constexpr std::uint64_t kReported = 40;  ///< violations of one rule that are written one by one

/// Sorts, and returns the value below which this share of the values is; 0 without values.
double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void say_one_by_one(const std::string& text) {
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  apps::say(text);
}

}  // namespace

void Tally::begin_life(const LifePlan& plan) {
  const StreamPlan& stream = plan.stream;
  seed_ = stream.seed;
  life_failed_ = false;
  ++lives_;
  ++endings_[static_cast<std::size_t>(plan.ending)];
  ++whens_[static_cast<std::size_t>(plan.when)];
  ++walls_[static_cast<std::size_t>(plan.walls)];
  ++limits_[static_cast<std::size_t>(stream.limit_class)];
  ++conditions_[static_cast<std::size_t>(stream.end.kind)];
  for (const Dimension& dimension : stream.dimensions) {
    ++kinds_[static_cast<std::size_t>(dimension.kind)];
  }
  const auto& methods = testing::streaming_methods();
  const auto method = std::ranges::find(methods, stream.window.interpolant.method);
  ++methods_[static_cast<std::size_t>(method - methods.begin())];
  laws_ += stream.live.follows_law ? 1U : 0U;
  description_ = fmt::format("{}, lag {}, {} dimensions, {} limits, {} walls, {} {}, {}",
                             stream.window.interpolant.method->name, stream.window.settle,
                             stream.dimensions.size(),
                             kLimitNames[static_cast<std::size_t>(stream.limit_class)],
                             to_string(plan.walls), to_string(plan.ending), to_string(plan.when),
                             kConditionNames[static_cast<std::size_t>(stream.end.kind)]);
}

void Tally::breach(Rule rule, const std::string& what) {
  const auto row = static_cast<std::size_t>(rule);
  life_failed_ = true;
  if (++breaches_[row] > kReported) return;
  say_one_by_one(fmt::format("seed {} ({}): {}: {}", seed_, description_, kViolations[row], what));
}

void Tally::count_end(ipc::EndKind kind, Time late) {
  ++ends_[static_cast<std::size_t>(kind)];
  if (kind == ipc::EndKind::slowed) lateness_.push_back(to_seconds(late));
}

void Tally::add(const Tally& other) {
  const auto sum = [](auto& to, const auto& from) {
    std::ranges::transform(to, from, to.begin(), std::plus<>());
  };
  lives_ += other.lives_;
  laws_ += other.laws_;
  sum(breaches_, other.breaches_);
  sum(events_, other.events_);
  sum(endings_, other.endings_);
  sum(whens_, other.whens_);
  sum(walls_, other.walls_);
  sum(limits_, other.limits_);
  sum(ends_, other.ends_);
  sum(conditions_, other.conditions_);
  sum(methods_, other.methods_);
  sum(kinds_, other.kinds_);
  errors_.insert(errors_.end(), other.errors_.begin(), other.errors_.end());
  lateness_.insert(lateness_.end(), other.lateness_.begin(), other.lateness_.end());
}

nlohmann::json Tally::found() const {
  nlohmann::json all = nlohmann::json::object();
  for (std::size_t i = 0; i < kRules; ++i) {
    all[std::string(kViolations[i])] = breaches_[i];
  }
  return all;
}

std::vector<std::pair<std::string, std::uint64_t>> Tally::required() const {
  std::vector<std::pair<std::string, std::uint64_t>> all;
  const auto list = [&all](std::string_view what, const auto& names, const auto& counts) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      all.emplace_back(fmt::format("{}{}", what, names[i]), counts[i]);
    }
  };
  list("", kEventNames, events_);
  for (std::size_t i = 0; i < kEndings; ++i) {
    all.emplace_back(fmt::format("lives that end by {}", to_string(static_cast<Ending>(i))),
                     endings_[i]);
  }
  for (std::size_t i = 0; i < kWhens; ++i) {
    all.emplace_back(fmt::format("lives that end {}", to_string(static_cast<When>(i))), whens_[i]);
  }
  for (std::size_t i = 0; i < kWalls; ++i) {
    all.emplace_back(fmt::format("lives with {} walls", to_string(static_cast<Walls>(i))),
                     walls_[i]);
  }
  for (std::size_t i = 0; i < kLimitClasses; ++i) {
    all.emplace_back(fmt::format("lives with {} limits", kLimitNames[i]), limits_[i]);
  }
  for (std::size_t i = 1; i < ipc::kEndKinds; ++i) {
    all.emplace_back(fmt::format("ends {}", kEndNames[i]), ends_[i]);
  }
  for (std::size_t i = 0; i < conditions_.size(); ++i) {
    if (!is_online(static_cast<ConditionKind>(i))) continue;
    all.emplace_back(fmt::format("finishes {}", kConditionNames[i]), conditions_[i]);
  }
  list("dimensions ", kKindNames, kinds_);
  const auto& methods = testing::streaming_methods();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    all.emplace_back(fmt::format("lives of {}", methods[i]->name), methods_[i]);
  }
  all.emplace_back("lives under a law", laws_);
  return all;
}

nlohmann::json Tally::measured() const {
  nlohmann::json all = nlohmann::json::object();
  for (const auto& [name, count] : required()) all[name] = count;
  auto errors = errors_;
  auto lateness = lateness_;
  all["path error of slowed ends, p99 [of the way]"] = quantile(errors, 0.99);
  all["path error of slowed ends, worst [of the way]"] = quantile(errors, 1);
  all["lateness of slowed ends, p99 [s]"] = quantile(lateness, 0.99);
  all["lateness of slowed ends, worst [s]"] = quantile(lateness, 1);
  return all;
}

std::vector<std::string> Tally::not_covered() const {
  std::vector<std::string> names;
  for (const auto& [name, count] : required()) {
    if (count == 0) names.push_back(name);
  }
  return names;
}

}  // namespace splinecast::campaign::ends
