#include "splinecast/core/run_beginning.hpp"

#include <algorithm>

namespace splinecast::core {

RunBeginning::RunBeginning(std::size_t dimensions)
    : dimensions_(dimensions), values_(kValues * dimensions) {}

void RunBeginning::begin(std::span<const StandingWaypoint> before) noexcept {
  h_before_ = 0;
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

void RunBeginning::update(KnotRing& knots) noexcept {
  RunStart at;
  if (standing_ > 0) {
    h_before_ = to_seconds(knots.row(0).time - before_);
    write_chord(values(kBefore), knots.values(0, KnotRing::kWaypoint), h_before_, values(kChord));
    at.before = {.h = h_before_, .chord = values(kChord)};
    knots.lead_in(at.before);
  }
  if (standing_ > 1) at.before2 = {.h = to_seconds(before_ - before2_), .chord = values(kChord2)};
  const auto after = [&knots](std::size_t i) {
    return ChordInterval{.h = knots.row(i).h, .chord = knots.values(i, KnotRing::kChord)};
  };
  if (knots.size() > 1) at.after = after(0);
  if (knots.size() > 2) at.after2 = after(1);
  write_run_start(at, values(kKnotVelocity));
}

}  // namespace splinecast::core
