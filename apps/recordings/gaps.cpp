#include "apps/recordings/gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/cli/options.hpp"
#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array kGapPolicies{GapPolicy::split, GapPolicy::bridge, GapPolicy::refuse};

std::optional<GapPolicy> parse_gap_policy(std::string_view text) {
  const auto* const found = std::ranges::find_if(
      kGapPolicies, [&](GapPolicy policy) { return to_string(policy) == text; });
  return found == kGapPolicies.end() ? std::nullopt : std::optional(*found);
}

std::string_view past_tense(GapPolicy policy) {
  return policy == GapPolicy::split ? "split" : "bridged";
}

}  // namespace

std::string_view to_string(GapPolicy policy) noexcept {
  switch (policy) {
    case GapPolicy::split:
      return "split";
    case GapPolicy::bridge:
      return "bridge";
    case GapPolicy::refuse:
      return "refuse";
  }
  return "unknown";
}

std::optional<GapOptions> parse_gap(std::string_view text) {
  if (const auto policy = parse_gap_policy(text)) return GapOptions{.policy = *policy};
  const std::size_t colon = text.find(':');
  GapOptions options;
  options.longer_than = parse_time(text.substr(0, colon), TimeUnit::seconds);
  if (!options.longer_than || *options.longer_than <= Time::zero()) return std::nullopt;
  if (colon == std::string_view::npos) return options;
  const auto policy = parse_gap_policy(text.substr(colon + 1));
  if (!policy) return std::nullopt;
  options.policy = *policy;
  return options;
}

Time gap_length(const GapOptions& options, Time median) noexcept {
  constexpr std::int64_t kMedians = 10;
  constexpr Time kLeast = std::chrono::milliseconds(500);
  return options.longer_than.value_or(std::max(saturated_product(median, kMedians), kLeast));
}

void add_gap(Command& verb, GapOptions& gap) {
  verb.option(
          "--gap",
          [&gap](const std::string& text) {
            const auto read = parse_gap(text);
            if (!read) {
              throw UsageError("--gap",
                               fmt::format("'{}' is not a time above 0 in s, one of split, "
                                           "bridge, refuse, or both as S:POLICY",
                                           text));
            }
            gap = *read;
          },
          "A gap is a pause of the source longer than S seconds (default: ten median intervals, at "
          "least 0.5). split (default): stop there, and start again for the next row; bridge: one "
          "segment; refuse: refuse the file")
      .type("[S:]split|bridge|refuse");
}

std::string gap_refusal(const std::string& place, Time length, const std::string& before) {
  return fmt::format("{}: a gap of {} s after {}; --gap split or --gap bridge accepts it", place,
                     to_seconds(length), before);
}

void Gaps::add(const Gap& gap) noexcept {
  ++count;
  if (listed < kListed) {
    largest[listed++] = gap;
  } else if (gap.length > largest.back().length) {
    largest.back() = gap;
  }
  for (std::size_t i = listed - 1; i > 0 && largest[i].length > largest[i - 1].length; --i) {
    std::swap(largest[i], largest[i - 1]);
  }
}

nlohmann::ordered_json to_json(const Gaps& gaps, GapPolicy policy) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < gaps.listed; ++i) {
    const Gaps::Gap& gap = gaps.largest[i];
    list.push_back({{"s", to_seconds(gap.length)}, {"after", gap.after}, {"before", gap.before}});
  }
  return {{"policy", to_string(policy)}, {"count", gaps.count}, {"longest", std::move(list)}};
}

std::string in_words(const Gaps& gaps, GapPolicy policy, std::string_view row_name) {
  if (gaps.count == 0) return {};
  const Gaps::Gap& longest = gaps.largest.front();
  return fmt::format("{0} gap{1} {2}, the longest {3:.6g} s from {4} {5} to {4} {6}", gaps.count,
                     gaps.count == 1 ? "" : "s", past_tense(policy), to_seconds(longest.length),
                     row_name, longest.after, longest.before);
}

}  // namespace splinecast::apps
