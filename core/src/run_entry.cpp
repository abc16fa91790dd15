#include "splinecast/core/run_entry.hpp"

#include <algorithm>

namespace splinecast::core {

RunEntry::RunEntry(std::size_t dimensions)
    : dimensions_(dimensions), values_(kValues * dimensions) {}

void RunEntry::begin(const Instant& from, std::span<const StandingWaypoint> before) noexcept {
  time_ = from.time;
  h_before_ = 0;
  std::ranges::copy(from.position, values(kPosition).begin());
  std::ranges::copy(from.velocity, values(kVelocity).begin());
  std::ranges::copy(from.acceleration, values(kAcceleration).begin());
  standing_ = std::min<std::size_t>(before.size(), 2);
  if (standing_ > 0) {
    before_ = before.back().time;
    std::ranges::copy(before.back().position, values(kBefore).begin());
  }
  if (standing_ > 1) {
    const StandingWaypoint& second = before[before.size() - 2];
    before2_ = second.time;
    std::ranges::copy(second.position, values(kBefore2).begin());
    write_chord(second.position, values(kBefore), to_seconds(before_ - before2_), values(kChord2));
  }
}

void RunEntry::update(KnotRing& knots) noexcept {
  RunStart at;
  if (standing_ > 0) {
    h_before_ = to_seconds(knots.row(0).time - before_);
    write_chord(values(kBefore), knots.values(0, KnotRing::kWaypoint), h_before_, values(kChord));
    at.before = {.h = h_before_, .chord = values(kChord)};
    lead_in(knots);
  }
  if (standing_ > 1) at.before2 = {.h = to_seconds(before_ - before2_), .chord = values(kChord2)};
  const auto after = [&knots](std::size_t i) {
    return ChordInterval{.h = knots.row(i).h, .chord = knots.values(i, KnotRing::kChord)};
  };
  if (knots.size() > 1) at.after = after(0);
  if (knots.size() > 2) at.after2 = after(1);
  write_run_start(at, values(kKnotVelocity), values(kKnotAcceleration));
}

void RunEntry::take_acceleration(const KnotRing& knots) noexcept {
  if (knots.size() < 2) return;
  write_left_acceleration(knots.interval(0), values(kKnotAcceleration));
}

void RunEntry::take(std::span<const double> velocity,
                    std::span<const double> acceleration) noexcept {
  std::ranges::copy(velocity, values(kKnotVelocity).begin());
  std::ranges::copy(acceleration, values(kKnotAcceleration).begin());
}

void RunEntry::keep() noexcept {
  std::ranges::copy(values(kKnotVelocity), values(kKeptVelocity).begin());
  std::ranges::copy(values(kKnotAcceleration), values(kKeptAcceleration).begin());
}

void RunEntry::restore_acceleration() noexcept {
  std::ranges::copy(values(kKeptAcceleration), values(kKnotAcceleration).begin());
}

void RunEntry::swap_velocities() noexcept {
  std::ranges::swap_ranges(values(kKnotVelocity), values(kKeptVelocity));
}

void RunEntry::write_splice(const KnotRing& knots, Segment& out) const noexcept {
  build_splice(state(),
               {.time = knots.row(0).time,
                .position = knots.position(0),
                .velocity = knots.values(0, KnotRing::kVelocity),
                .acceleration = acceleration()},
               out);
}

}  // namespace splinecast::core
