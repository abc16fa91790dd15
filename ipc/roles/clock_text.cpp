#include <time.h>

#include <array>
#include <chrono>

#include "core/basics/number_text.hpp"
#include "splinecast/clock.hpp"

namespace splinecast {
namespace {

/// What a time may be instead of nanoseconds of CLOCK_MONOTONIC: a reading of a clock in
/// another unit.
struct Guess {
  const char* text;
  Time now;
  std::int64_t unit;  ///< ns
};

/// Whether a count of units is within a day of the clock's reading.
bool is_like(Time time, const Guess& guess) noexcept {
  constexpr Time kDay = std::chrono::hours(24);
  const std::int64_t now = guess.now.count() / guess.unit;
  const std::int64_t day = kDay.count() / guess.unit;
  return time.count() > now - day && time.count() < now + day;
}

/// The clock that a time looks like; nullptr: none.
const char* clock_like(Time time, Time now) noexcept {
  timespec real{};
  ::clock_gettime(CLOCK_REALTIME, &real);
  const Time wall = std::chrono::seconds(real.tv_sec);
  const std::array<Guess, 4> walls{{{"CLOCK_REALTIME", wall, 1},
                                    {"CLOCK_REALTIME in µs", wall, 1'000},
                                    {"CLOCK_REALTIME in ms", wall, 1'000'000},
                                    {"CLOCK_REALTIME in s", wall, 1'000'000'000}}};
  for (const Guess& guess : walls) {
    if (is_like(time, guess)) return guess.text;
  }
  constexpr Time kRecent = std::chrono::minutes(1);
  if (time > now - kRecent) return nullptr;
  if (time == Time::zero()) return "a time that counts from 0";
  const auto is_of_now = [&](std::int64_t unit) {
    const std::int64_t minute = Time(std::chrono::minutes(1)) / Time(unit);
    return std::abs(time.count() - now.count() / unit) <= minute;
  };
  if (is_of_now(1'000'000'000)) return "CLOCK_MONOTONIC in s as an integer, which counts as ns";
  if (is_of_now(1'000'000)) return "CLOCK_MONOTONIC in ms as an integer, which counts as ns";
  if (is_of_now(1'000)) return "CLOCK_MONOTONIC in µs as an integer, which counts as ns";
  return time > Time::zero() && time < kRecent ? "a time that counts from 0" : nullptr;
}

}  // namespace

std::string compared_with_now(Time time) {
  const Time now = MonotonicClock().now();
  const auto seconds = [](double ns) { return core::number_text(ns / 1e9) + " s"; };
  const double ahead = static_cast<double>(time.count()) - static_cast<double>(now.count());
  std::string text = seconds(static_cast<double>(time.count())) + " is " +
                     seconds(std::abs(ahead)) + (ahead < 0 ? " before" : " after") + " now, " +
                     seconds(static_cast<double>(now.count())) + " of CLOCK_MONOTONIC";
  const char* const clock = clock_like(time, now);
  return clock == nullptr ? text : text + "; it looks like " + clock;
}

}  // namespace splinecast
