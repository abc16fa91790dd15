#include "tests/campaign/requests/facts.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::campaign {
namespace {

constexpr double kPerOctave = 8;
constexpr double kShortest = 1000;  ///< ns

double milliseconds_of(Time time) { return std::round(to_seconds(time) * 1e6) / 1e3; }

}  // namespace

void SharedTimes::note(Time time) noexcept {
  const double ratio = std::max(static_cast<double>(time.count()) / kShortest, 1.0);
  const auto bucket = static_cast<std::size_t>(kPerOctave * std::log2(ratio));
  ++counts_[std::min(bucket, kBuckets - 1)];
  for (std::int64_t longest = longest_; longest < time.count();) {
    if (longest_.compare_exchange_weak(longest, time.count())) break;
  }
}

Time SharedTimes::quantile(double share) const noexcept {
  std::uint64_t all = 0;
  for (const auto& count : counts_) all += count;
  std::uint64_t below = 0;
  std::size_t bucket = 0;
  for (; bucket < kBuckets; ++bucket) {
    below += counts_[bucket];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) break;
  }
  const double end = std::exp2(static_cast<double>(bucket + 1) / kPerOctave);
  return std::min(Time(static_cast<std::int64_t>(kShortest * end)), longest());
}

nlohmann::json RequestFacts::found() const {
  return {{"requests lost", lost.load()},
          {"holds after which the law moved", not_held.load()},
          {"dead men that a renewal has ended", revived.load()},
          {"samples above a bound", exceeded.load()},
          {"processes that failed", failed.load()},
          {"stops and releases lost", lost_stops.load()},
          {"samples that moved although a stopper held the stream", moved_while_held.load()}};
}

nlohmann::json RequestFacts::measured() const {
  return {{"rates", rates.load()},
          {"holds", holds.load()},
          {"releases", releases.load()},
          {"dead men", dead_men.load()},
          {"renewals", renewals.load()},
          {"samples compared with the bounds", samples.load()},
          {"solvers killed", solvers_killed.load()},
          {"solvers stopped for 1 to 300 ms", solvers_stopped.load()},
          {"commanders killed", commanders_killed.load()},
          {"stops", stops.load()},
          {"stops released", stops_released.load()},
          {"stops found after their stopper was killed", stops_left.load()},
          {"stoppers killed", stoppers_killed.load()},
          {"samples while a stopper held the stream", looks_at_rest.load()},
          {"appends stopped", appends_stopped.load()},
          {"streams created again", streams_created.load()},
          {"request to effect, p50 [ms]", milliseconds_of(effects.quantile(0.5))},
          {"request to effect, p99 [ms]", milliseconds_of(effects.quantile(0.99))},
          {"request to effect, largest [ms]", milliseconds_of(effects.longest())},
          {"stop to commit, p50 [ms]", milliseconds_of(stopped.quantile(0.5))},
          {"stop to commit, p99 [ms]", milliseconds_of(stopped.quantile(0.99))},
          {"stop to commit, largest [ms]", milliseconds_of(stopped.longest())}};
}

}  // namespace splinecast::campaign
