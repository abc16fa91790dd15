#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::campaign {

/// Waypoints that prove themselves, and with them the curve through them.
///
/// Waypoint n stands at `origin + n·interval`, and its position is a function of n alone, so that a
/// waypoint under another's time shows. Dimension d is dimension 0 times ±a power of two; the solve
/// treats dimensions alike and is linear in them, and such a factor costs no rounding, so the same
/// holds, bit for bit, of every coefficient and of every sample: a copy that is mixed of two
/// versions within a row of dimensions shows. A mixture between rows shows where segments meet.
class Payload {
 public:
  static constexpr std::size_t kDimensions = 4;
  using Row = std::array<double, kDimensions>;

  /// How positions follow one another.
  enum class Shape {
    rough,   ///< without any order: what one version of the curve has, another has not
    smooth,  ///< a cosine in time, for a stream that is spliced
  };

  Payload(Time origin, Time interval, Shape shape);

  [[nodiscard]] Time interval() const noexcept { return interval_; }
  [[nodiscard]] Time time_of(ipc::Word number) const noexcept;

  /// The waypoint at a time, if one may stand there.
  [[nodiscard]] std::optional<ipc::Word> number_at(Time t) const noexcept;

  /// The first waypoint at or after a time.
  [[nodiscard]] ipc::Word number_from(Time t) const noexcept;

  [[nodiscard]] Row position_of(ipc::Word number) const noexcept;

  /// Whether rows of kDimensions values each, one after the other, are rows of one version.
  [[nodiscard]] static bool is_whole(std::span<const double> rows) noexcept;

 private:
  Time origin_;
  Time interval_;
  Shape shape_;
};

}  // namespace splinecast::campaign
