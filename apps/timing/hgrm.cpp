#include "apps/timing/hgrm.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace splinecast::apps {
namespace {

constexpr double kStepsPerHalf = 5;
constexpr double kUnit = 1000;  // ns

double next_level(double level) {
  const double halves = std::floor(std::log(100 / (100 - level)) / std::log(2)) + 1;
  return level + 100 / (kStepsPerHalf * std::exp2(halves));
}

/// A number with twelve decimals; halves round up, as in Java.
std::string twelve_digits(double share) {
  constexpr std::int64_t kOne = 1'000'000'000'000;
  const auto digits = static_cast<std::int64_t>(std::floor(share * kOne + 0.5));
  return fmt::format("{}.{:012}", digits / kOne, digits % kOne);
}

double in_units(Time time) { return static_cast<double>(time.count()) / kUnit; }

}  // namespace

void for_each_percentile(const Histogram& histogram,
                         const std::function<void(const PercentileStep&)>& visit) {
  const auto& counts = histogram.counts();
  const auto all = static_cast<double>(histogram.count());
  std::uint64_t up_to = 0;
  double level = 0;
  for (std::size_t cell = 0; cell < counts.size(); ++cell) {
    if (counts[cell] == 0) continue;
    up_to += counts[cell];
    const Time value(Histogram::last_of(cell));
    const double reached = 100 * static_cast<double>(up_to) / all;
    // The last cell gives one step, even if it reaches several levels, and then the step to 100 %.
    while (reached >= level) {
      visit({.value = value, .level = level, .up_to = up_to});
      level = next_level(level);
      if (up_to == histogram.count()) break;
    }
    if (up_to == histogram.count()) visit({.value = value, .level = 100, .up_to = up_to});
  }
}

std::string percentile_text(const Histogram& histogram) {
  std::string text = fmt::format("{:>12} {:>14} {:>10} {:>14}\n\n", "Value", "Percentile",
                                 "TotalCount", "1/(1-Percentile)");
  const auto to = std::back_inserter(text);
  Time greatest{};
  for_each_percentile(histogram, [&](const PercentileStep& step) {
    greatest = step.value;
    const double share = step.level / 100;
    fmt::format_to(to, "{:12.3f} {} {:10}", in_units(step.value), twelve_digits(share), step.up_to);
    if (step.level < 100) fmt::format_to(to, " {:14.2f}", 1 / (1 - share));
    text += '\n';
  });
  fmt::format_to(to, "#[Mean    = {:12.3f}, StdDeviation   = {:12.3f}]\n", histogram.mean() / kUnit,
                 histogram.deviation() / kUnit);
  fmt::format_to(to, "#[Max     = {:12.3f}, Total count    = {:12}]\n", in_units(greatest),
                 histogram.count());
  fmt::format_to(to, "#[Buckets = {:12}, SubBuckets     = {:12}]\n", Histogram::kBuckets,
                 Histogram::kCells);
  return text;
}

}  // namespace splinecast::apps
