#include "tests/campaign/motions/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace splinecast::campaign {
namespace {

constexpr double kLength = Sines::kSeconds;

/// Moves all calls within a pause to its end.
void pause(Schedule& schedule, double from, double until) {
  schedule.pauses.emplace_back(from, until);
  for (Call& call : schedule.calls) {
    if (call.at >= from && call.at < until) call.at = until;
  }
}

Schedule late(const Sines& motion, std::uint64_t seed) {
  constexpr double kLead = 0.06;
  Schedule schedule = steady(motion, 30, kLead);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> lateness(0, 0.09);
  double before = -kLead;
  for (Call& call : schedule.calls) before = call.at = std::max(before, call.at + lateness(random));
  return schedule;
}

Schedule chunks(const Sines& motion, std::uint64_t /*seed*/) {
  constexpr double kInterval = 1.0 / 30;
  constexpr double kLead = 0.06;
  constexpr int kActions = 8;
  Schedule schedule;
  for (double now = -kLead; now + kLead < kLength; now += kActions / 2 * kInterval) {
    Call call;
    call.at = now;
    if (now > 0) call.replaces_from = now + kLead;
    for (int i = now > 0 ? 1 : 0; i <= kActions; ++i) {
      call.times.push_back(now + kLead + i * kInterval);
      call.positions.push_back(motion.positions(call.times.back()));
    }
    schedule.calls.push_back(std::move(call));
  }
  return schedule;
}

Schedule never_late(const Sines& motion, std::uint64_t /*seed*/) {
  return steady(motion, 100, 0.2);
}

Schedule with_silences(const Sines& motion, double lead) {
  Schedule schedule = steady(motion, 100, lead);
  for (double from = 2; from + 0.3 < kLength; from += 2) pause(schedule, from, from + 0.3);
  return schedule;
}
Schedule long_lead(const Sines& motion, std::uint64_t /*seed*/) {
  return with_silences(motion, 0.2);
}
Schedule short_lead(const Sines& motion, std::uint64_t /*seed*/) {
  return with_silences(motion, 0.06);
}

Schedule covered(const Sines& motion, std::uint64_t /*seed*/) { return with_silences(motion, 0.4); }

Schedule one_pause(const Sines& motion, std::uint64_t /*seed*/) {
  Schedule schedule = steady(motion, 100, 0.06);
  pause(schedule, 8, 8.3);
  return schedule;
}

/// The schedule of one_pause at 1 kHz, the rate of an encoder.
Schedule encoders(const Sines& motion, std::uint64_t /*seed*/) {
  Schedule schedule = steady(motion, 1000, 0.06);
  pause(schedule, 8, 8.3);
  return schedule;
}

Schedule deaths(const Sines& motion, std::uint64_t seed) {
  Schedule schedule = steady(motion, 100, 0.06);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> length(0.02, 0.4);
  for (double from = 2; from + 1 < kLength; from += 2) {
    pause(schedule, from, from + length(random));
    schedule.deaths.emplace_back(from + 1, from + 1 + length(random) / 2);
  }
  return schedule;
}

/// A recording that was interrupted while the motion continued.
Schedule gap(const Sines& motion, std::uint64_t /*seed*/) {
  Schedule schedule = steady(motion, 100, 0.05);
  schedule.pauses.emplace_back(6, 7.7);
  std::erase_if(schedule.calls,
                [](const Call& call) { return call.times[0] >= 6 && call.times[0] < 7.7; });
  return schedule;
}

/// Plans that differ by 3 mrad; each replaces the future from 60 ms ahead.
Schedule plans(const Sines& motion, std::uint64_t /*seed*/) {
  constexpr double kDifference = 3e-3;
  Schedule schedule = steady(motion, 100, 0.2);
  double offset = 0;
  double next = 1;
  for (Call& call : schedule.calls) {
    if (call.at >= next) {
      next += 0.5;
      offset = kDifference - offset;
      // Replaces the waypoints from 60 ms ahead to the newest one.
      const double newest = call.times[0];
      call.replaces_from = call.at + 0.06;
      schedule.offsets.emplace_back(*call.replaces_from, offset);
      call.times.clear();
      call.positions.clear();
      for (double t = newest - 0.13; t <= newest + 1e-9; t += 0.01) {
        call.times.push_back(t);
        call.positions.push_back(motion.positions(t));
      }
    }
    for (auto& position : call.positions) {
      for (double& x : position) x += offset;
    }
  }
  return schedule;
}

constexpr std::array kFaults{
    Fault{"30 Hz, lead 60 ms, each 0 to 90 ms late",
          "late",
          late,
          0,
          false,
          {{{0.004, 0.005}, {0.001, 0.002}, {0.0005, 0.0005}}}},
    Fault{"chunks of 8 waypoints by replace_from, 30 Hz, lead 60 ms", "chunks", chunks},
    Fault{"100 Hz, lead 200 ms, never late, start in motion",
          "start",
          never_late,
          0,
          true,
          {{{0.0005, 0.0005}, {0.0005, 0.0005}, {0.0005, 0.0005}}}},
    Fault{"100 Hz, lead 200 ms, 300 ms of silence every 2 s",
          "pauses_long_lead",
          long_lead,
          0,
          false,
          {{{0.14, 0.15}, {0.03, 0.05}, {0.017, 0.029}}}},
    Fault{"100 Hz, lead 60 ms, 300 ms of silence every 2 s",
          "pauses_short_lead",
          short_lead,
          0,
          false,
          {{{0.33, 0.34}, {0.21, 0.22}, {0.16, 0.18}}}},
    Fault{"100 Hz, lead 400 ms, 300 ms of silence every 2 s", "", covered, 0, true},
    Fault{"100 Hz, lead 60 ms, one pause of 300 ms", "one_pause", one_pause},
    Fault{"100 Hz, lead 60 ms, deaths of producer and solver", "deaths", deaths},
    Fault{"100 Hz, lead 50 ms, a gap of 1.7 s in the recording", "gap", gap},
    Fault{"plans by replace_from that differ by 3 mrad, 60 ms ahead", "plans", plans},
    Fault{"1 kHz encoders of 0.1 mrad, lead 60 ms, one pause of 300 ms", "encoders", encoders,
          1e-4},
};

}  // namespace

Schedule steady(const Motion& motion, double rate, double lead) {
  Schedule schedule;
  const int count = static_cast<int>(motion.seconds() * rate);
  for (int i = 0; i < count; ++i) {
    const double t = i / rate;
    schedule.calls.push_back({.at = t - lead, .times = {t}, .positions = {motion.positions(t)}});
  }
  return schedule;
}

std::span<const Fault> faults() { return kFaults; }

}  // namespace splinecast::campaign
