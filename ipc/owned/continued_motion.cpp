#include "ipc/owned/continued_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/forms/chord.hpp"
#include "core/limits/check.hpp"
#include "core/limits/limit_of.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::ipc {
namespace {

/// Whether an item has a position on the curve.
bool has_position(ItemKind kind) noexcept {
  return kind == ItemKind::waypoint || kind == ItemKind::start_state;
}

/// Completes limits that are given by those that are shown; those of a quaternion are |ω| ≤ 2|q̇|.
void complete(std::vector<double>& given, std::span<const double> shown,
              const DimensionKinds& kinds) {
  given.resize(shown.size());
  for (const QuaternionDimensions& q : kinds.quaternions()) {
    double largest = 0;
    for (std::size_t i = 0; i < kQuaternionSize; ++i) {
      largest = std::hypot(largest, shown[q.first + i]);
    }
    if (given[q.first] == 0) given[q.first] = 2 * largest;
  }
  for (std::size_t d = 0; d < given.size(); ++d) {
    if (given[d] == 0) given[d] = std::max(shown[d], std::numeric_limits<double>::min());
  }
}

}  // namespace

ContinuedMotion::ContinuedMotion(const WaypointRingReader& ring, const KnotBoardReader& board,
                                 const RegionHeader& header)
    : ring_(&ring),
      board_(&board),
      kinds_(dimension_kinds(header)),
      stop_length_(window_options(header).stop_length),
      given_(core::limits_at_rate(window_options(header).limits, max_rate(header))),
      shown_(board),
      item_(header.dimensions),
      position_(header.dimensions),
      last_(header.dimensions),
      velocity_before_(header.dimensions),
      coefficients_(3 * header.dimensions) {}

/// The given limits of velocity and acceleration; where none is given, those that the motion shows.
MotionLimits ContinuedMotion::limits() const {
  MotionLimits limits{.velocity = given_.velocity, .acceleration = given_.acceleration};
  complete(limits.velocity, shown_.limits().velocity, kinds_);
  complete(limits.acceleration, shown_.limits().acceleration, kinds_);
  return limits;
}

/// Copies an item with a position. The producer of the ring has written it, so it is whole.
bool ContinuedMotion::read(Word item) noexcept {
  const Word written = ring_->written();
  if (item >= written || written - item > ring_->capacity()) return false;
  ring_->copy(item, item_);
  return has_position(item_.kind) && kinds_.takes(item_.waypoint().position);
}

/// Whether the chord from the newest item to the position, `interval` later, keeps the limits. The
/// chord before it has the length `before`.
bool ContinuedMotion::keeps(const MotionLimits& limits, Time interval, Time before) {
  const std::size_t dimensions = position_.size();
  const std::span<double> values(coefficients_);
  const auto velocity = values.subspan(dimensions, dimensions);
  std::ranges::copy(last_, values.begin());
  core::write_chord(last_, position_, to_seconds(interval), velocity);
  const core::SegmentPart line{.order = 2,
                               .coefficients = values.first(2 * dimensions),
                               .dimensions = dimensions,
                               .from = 0,
                               .to = to_seconds(interval)};
  if (!core::keeps_within({.velocity = limits.velocity}, &kinds_, line)) return false;
  // A motion within limits changes its mean velocity by at most as much as its acceleration allows
  // between the middles of the chords; a cubic through the three positions has up to 1.5 times
  // that.
  constexpr double kOfCubic = 1.5;
  const double middles = to_seconds(interval + before) / 2;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double change = velocity[d] - velocity_before_[d];
    values[2 * dimensions + d] = kOfCubic * change / middles / 2;
    velocity[d] = velocity_before_[d] + change / 2;
  }
  const core::SegmentPart bend{
      .order = 3, .coefficients = values.first(3 * dimensions), .dimensions = dimensions};
  return core::keeps_within({.acceleration = limits.acceleration}, &kinds_, bend);
}

bool ContinuedMotion::continues(const Waypoint& waypoint, Time settled) {
  const Word newest = ring_->written() - 1;
  if (!read(newest) || settled >= item_.time) return true;
  if (waypoint.time <= item_.time) return false;
  const Time time = item_.time;
  const Time interval = waypoint.time - time;
  std::ranges::copy(item_.waypoint().position, last_.begin());
  std::ranges::copy(waypoint.position, position_.begin());
  std::ranges::fill(velocity_before_, 0.0);
  Time before = interval;
  if (newest > 0 && read(newest - 1) && item_.time < time) {
    before = time - item_.time;
    kinds_.continue_from(item_.waypoint().position, {.position = last_});
    core::write_chord(item_.waypoint().position, last_, to_seconds(before), velocity_before_);
  }
  kinds_.continue_from(last_, {.position = position_});
  Summary summary;
  if (!board_->copy_newest_summary(summary)) return true;
  shown_.restore(*board_, summary, Time::max());
  shown_.look(stop_length_);
  return keeps(limits(), interval, before);
}

AppendStatus ContinuedMotion::append(const Waypoint& waypoint, WaypointRingWriter& writer,
                                     const WaypointRingWriter::Solved& known) {
  const bool is_usable = waypoint.position.size() == position_.size() && is_finite(waypoint) &&
                         kinds_.takes(waypoint.position);
  const Time settled = WaypointRingWriter::earliest_replacement(known);
  if (!is_usable || continues(waypoint, settled)) return writer.append(waypoint, known);
  return replace_motion(waypoint, writer, known);
}

AppendStatus replace_motion(const Waypoint& waypoint, WaypointRingWriter& writer,
                            const WaypointRingWriter::Solved& known) noexcept {
  const std::span<const Waypoint> path(&waypoint, 1);
  constexpr Time kSoonest = WaypointRingWriter::kSoonest;
  const bool is_late = writer.check_replacement(kSoonest, path, known) == AppendStatus::too_late;
  return is_late ? writer.counted(AppendStatus::past) : writer.replace_from(kSoonest, path, known);
}

}  // namespace splinecast::ipc
