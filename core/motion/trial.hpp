#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/limits/check.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// An excess, and when the curve has it.
struct TimedExcess {
  Excess excess{};
  Time time{};
};

/// Which dimensions' bounds count for a stop: of all, or of those with a limit of acceleration.
enum class StopBounds { all, limited };

/// Where a stop exceeds a limit of acceleration or jerk of a window, or passes a bound; nothing if
/// it keeps them. Its velocity only falls. `scratch`: D values. O(D).
[[nodiscard]] std::optional<TimedExcess> excess_of_stop(const SlidingWindow& window,
                                                        const Segment& stop, StopBounds bounds,
                                                        std::span<double> scratch) noexcept;

/// A copy of a window that is changed first, to compare the change with the limits of the window.
/// Allocates only when constructed; one thread uses it.
class Trial {
 public:
  /// `options` are those of the windows that are copied. Throws as SlidingWindow does.
  Trial(std::size_t dimensions, const WindowOptions& options);

  /// Makes the trial a copy of a window. O(K·D).
  void begin(const SlidingWindow& window) noexcept { window_.copy_from(window, knots_); }

  /// The copy.
  [[nodiscard]] SlidingWindow& window() noexcept { return window_; }
  [[nodiscard]] const SlidingWindow& window() const noexcept { return window_; }

  /// The largest excess of the copy's segments between knots, from segment `first` on; nothing if
  /// they keep the limits. Segments that exceed a limit in `unchanged`, too, do not count; null:
  /// all count. O(K·D).
  [[nodiscard]] std::optional<TimedExcess> worst_excess(std::size_t first,
                                                        const SlidingWindow* unchanged) noexcept;

  /// Whether each of these segments keeps `limits`, or exceeds none more than in `unchanged`.
  [[nodiscard]] bool exceeds_no_more(const MotionLimits& limits, std::size_t first,
                                     const SlidingWindow& unchanged) noexcept;

  /// The excess of a stop, with the bounds of all dimensions.
  [[nodiscard]] std::optional<TimedExcess> excess_of_stop(const Segment& stop) noexcept {
    return core::excess_of_stop(window_, stop, StopBounds::all, values_);
  }

  /// The excess of the stop after the copy's newest knot, with the bounds of limited dimensions.
  [[nodiscard]] std::optional<TimedExcess> excess_of_newest_stop() noexcept;

 private:
  SlidingWindow window_;
  std::vector<Knot> knots_;     ///< scratch
  Segment segment_;             ///< scratch
  Segment unchanged_;           ///< scratch
  std::vector<double> values_;  ///< scratch
};

}  // namespace splinecast::core
