#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::campaign {

/// Self-checking waypoints: a torn copy of a waypoint, or of the curve through them, is detected.
///
/// Waypoint n is at `origin + n·interval`, and its position is a function of n alone, so a position
/// with the time of another waypoint is detected. Dimension d is dimension 0 times ± a power of
/// two. The solve is linear and the same for each dimension, and multiplication by such a factor is
/// exact. So the dimensions of each coefficient and of each sample have the same factors, bit for
/// bit, and a row of dimensions that mixes two versions is detected. A mixture of rows is detected
/// where segments join.
class Payload {
 public:
  static constexpr std::size_t kDimensions = 4;
  using Row = std::array<double, kDimensions>;

  /// Sequence of the positions.
  enum class Shape {
    rough,   ///< pseudorandom, so that two versions of the curve always differ
    smooth,  ///< a cosine in time, for a stream with entries
  };

  Payload(Time origin, Time interval, Shape shape);

  [[nodiscard]] Time interval() const noexcept { return interval_; }
  [[nodiscard]] Time time_of(ipc::Word number) const noexcept;

  /// The number of the waypoint at t; nullopt if t is not the time of a waypoint.
  [[nodiscard]] std::optional<ipc::Word> number_at(Time t) const noexcept;

  /// The number of the first waypoint at or after t.
  [[nodiscard]] ipc::Word number_from(Time t) const noexcept;

  [[nodiscard]] Row position_of(ipc::Word number) const noexcept;

  /// Whether none of these consecutive rows of kDimensions values is torn.
  [[nodiscard]] static bool is_whole(std::span<const double> rows) noexcept;

 private:
  Time origin_;
  Time interval_;
  Shape shape_;
};

}  // namespace splinecast::campaign
