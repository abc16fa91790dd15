#include "tests/campaign/streams/findings.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/process/messages.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::array<std::string_view, kBreaches> kBreachNames{
    "settled samples changed",
    "position steps",
    "velocity steps",
    "samples with NaN or infinity",
    "curves that do not end at rest",
    "samples at now without values",
    "items lost",
    "waypoints missed",
    "settled times that decreased or were late",
    "samples at now that had not settled",
    "unchanged samples with the status revised",
    "changed samples without the status revised",
    "late_commits or deadline_misses miscounted",
    "stops that took effect late",
    "unbounded steps",
    "boards refused",
    "ring items torn",
    "curves not verified",
    "entries and stops beyond their limits",
    "stops that speed up or reverse"};

constexpr std::array<std::string_view, kEvents> kEventNames{"streams",
                                                            "revisions",
                                                            "starvations",
                                                            "entries",
                                                            "entries beyond the newest waypoint",
                                                            "entries replaced",
                                                            "stop segments",
                                                            "replacements",
                                                            "replacements with a blend",
                                                            "waypoints beyond a limit",
                                                            "replacements that cut the curve",
                                                            "stops",
                                                            "waypoints withdrawn",
                                                            "deadline_misses",
                                                            "late_commits",
                                                            "takeovers",
                                                            "takeovers of a torn publication",
                                                            "continuations by a new producer",
                                                            "producers that died within a call",
                                                            "starts in motion",
                                                            "finishes",
                                                            "finishes with an entry",
                                                            "solver delays",
                                                            "settled times raised without a step",
                                                            "waypoints interpolated",
                                                            "waypoints passed over",
                                                            "knots compared",
                                                            "settled samples read again",
                                                            "ring items observed",
                                                            "segments verified"};

/// Refusals that a producer without bad intent can cause.
constexpr std::array kRefusalsToSee{Refusal::past,
                                    Refusal::too_far_apart,
                                    Refusal::lag_too_short,
                                    Refusal::zero_quaternion,
                                    Refusal::lacks_derivatives,
                                    Refusal::beyond_limits,
                                    Refusal::cannot_follow};
/// Statuses of samples, without those that need another concurrent process.
constexpr std::array kStatusesToSee{SampleStatus::settled,       SampleStatus::provisional,
                                    SampleStatus::stopping,      SampleStatus::holding,
                                    SampleStatus::revised,       SampleStatus::no_data,
                                    SampleStatus::before_history};

constexpr std::array<std::string_view, kLimitClasses> kLimitNames{"no", "generous", "tight"};

/// Number of breaches of one campaign that are reported individually.
constexpr std::uint64_t kReported = 100;

template <std::size_t N>
std::uint64_t sum(const std::array<std::uint64_t, N>& counters) {
  std::uint64_t all = 0;
  for (const std::uint64_t count : counters) all += count;
  return all;
}

}  // namespace

std::string_view to_string(Breach breach) noexcept {
  return kBreachNames[static_cast<std::size_t>(breach)];
}

std::string_view to_string(Event event) noexcept {
  return kEventNames[static_cast<std::size_t>(event)];
}

void StreamFindings::begin_stream(const StreamPlan& plan) {
  seed_ = plan.seed;
  stream_failed_ = false;
  description_ =
      fmt::format("{}, lag {}, {} dimensions, {} limits", plan.window.interpolant.method->name,
                  plan.window.settle, plan.dimensions.size(),
                  kLimitNames[static_cast<std::size_t>(plan.limit_class)]);
  count(Event::streams);
  ++methods_[std::string(plan.window.interpolant.method->name)];
  ++limits_[static_cast<std::size_t>(plan.limit_class)];
  for (const Dimension& dimension : plan.dimensions) {
    ++kinds_[static_cast<std::size_t>(dimension.kind)];
  }
}

void StreamFindings::breach(Breach breach, const std::string& what) {
  ++breaches_[static_cast<std::size_t>(breach)];
  stream_failed_ = true;
  if (sum(breaches_) <= kReported) {
    apps::say(fmt::format("seed {} ({}): {}: {}", seed_, description_, to_string(breach), what));
  }
}

nlohmann::json StreamFindings::found() const {
  nlohmann::json all = nlohmann::json::object();
  for (std::size_t i = 0; i < kBreaches; ++i) all[std::string(kBreachNames[i])] = breaches_[i];
  return all;
}

/// The counters that must be above 0 at the end of a campaign.
std::map<std::string, std::uint64_t> StreamFindings::required() const {
  std::map<std::string, std::uint64_t> all;
  for (std::size_t i = 0; i < kEvents; ++i) all.emplace(kEventNames[i], events_[i]);
  for (const SampleStatus status : kStatusesToSee) {
    all.emplace(fmt::format("samples {}", to_string(status)),
                statuses_[static_cast<std::size_t>(status)]);
  }
  for (const Refusal refusal : kRefusalsToSee) {
    all.emplace(fmt::format("refused as {}", to_string(refusal)),
                refusals_[static_cast<std::size_t>(refusal)]);
  }
  // An earlier stream of the name, which `elsewhere` needs, is not simulated.
  for (std::size_t i = 0; i < static_cast<std::size_t>(AppendStatus::elsewhere); ++i) {
    all.emplace(fmt::format("calls {}", to_string(static_cast<AppendStatus>(i))), answers_[i]);
  }
  for (const Method* method : testing::streaming_methods()) {
    const auto found = methods_.find(std::string(method->name));
    all.emplace(fmt::format("streams of {}", method->name),
                found == methods_.end() ? 0 : found->second);
  }
  constexpr std::array kKinds{"linear", "periodic", "quaternion", "quaternion-wxyz"};
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    all.emplace(fmt::format("dimensions {}", kKinds[i]), kinds_[i]);
  }
  for (std::size_t i = 0; i < kLimitNames.size(); ++i) {
    all.emplace(fmt::format("streams with {} limits", kLimitNames[i]), limits_[i]);
  }
  return all;
}

nlohmann::json StreamFindings::coverage() const {
  nlohmann::json all = required();
  all["simulated seconds"] = simulated_;
  all["samples"] = sum(statuses_);
  all["refusals"] = sum(refusals_);
  for (std::size_t i = 0; i < refusals_.size(); ++i) {
    if (refusals_[i] == 0) continue;
    all[fmt::format("refused as {}", to_string(static_cast<Refusal>(i)))] = refusals_[i];
  }
  return all;
}

std::vector<std::string> StreamFindings::not_covered() const {
  std::vector<std::string> names;
  for (const auto& [name, count] : required()) {
    if (count == 0) names.push_back(name);
  }
  return names;
}

}  // namespace splinecast::campaign
