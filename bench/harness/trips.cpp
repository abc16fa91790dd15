#include "bench/harness/trips.hpp"

#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>

#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::bench {

Pinned::Pinned(int core) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<unsigned>(core), &one);
  if (sched_getaffinity(0, sizeof before_, &before_) != 0 ||
      sched_setaffinity(0, sizeof one, &one) != 0) {
    throw std::runtime_error("core " + std::to_string(core) + " is not available");
  }
}

Pinned::~Pinned() { sched_setaffinity(0, sizeof before_, &before_); }

double Trips::quantile(double q) {
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(ns_.size() - 1));
  std::nth_element(ns_.begin(), ns_.begin() + at, ns_.end());
  return static_cast<double>(ns_[static_cast<std::size_t>(at)]);
}

nlohmann::json Trips::summary() {
  return {{"p50_ns", quantile(0.5)}, {"p99_ns", quantile(0.99)}, {"trips", ns_.size()}};
}

Time clock_cost() {
  const MonotonicClock clock;
  constexpr std::size_t kPairs = 10'001;
  Trips pairs(kPairs);
  for (std::size_t i = 0; i < kPairs; ++i) {
    const Time start = clock.now();
    pairs.add(clock.now() - start);
  }
  return Time(static_cast<std::int64_t>(pairs.quantile(0.5)));
}

void report(benchmark::State& bench, const nlohmann::json& summary) {
  constexpr double kSecond = 1e9;
  bench.SetIterationTime(summary.at("p50_ns").get<double>() / kSecond);
  for (const auto& [name, value] : summary.items()) bench.counters[name] = value.get<double>();
}

SharedLines::SharedLines() {
  void* const memory = mmap(nullptr, kLines * sizeof(Line), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  lines_ = new (memory) Line[kLines]{};
}

SharedLines::~SharedLines() { munmap(lines_, kLines * sizeof(Line)); }

std::atomic<std::uint64_t>& SharedLines::operator[](std::size_t line) const {
  return lines_[line].word;
}

bool await(const std::atomic<std::uint64_t>& word, std::uint64_t wanted) {
  while (word.load(std::memory_order_acquire) != wanted) {
    if (apps::stop_requested()) return false;
  }
  return true;
}

}  // namespace splinecast::bench
