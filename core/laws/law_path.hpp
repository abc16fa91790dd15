#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/laws/rate_curve.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// Length of the straight line after the last piece of a law, on which it continues without any
/// process: about 36 years.
inline constexpr Time kLawLine{std::int64_t{1} << 60};

/// The waypoints of a law's curve from a state on: the ends of the pieces of its rate, and of the
/// straight line after them, each with position, rate and slope 0. Holds the values that its
/// waypoints are views of. Nothing allocates or throws. Source: math 32.
class LawPath {
 public:
  /// A path that begins in a state, which is not one of its waypoints.
  explicit LawPath(const LawState& from) noexcept : end_(from) {}
  LawPath(const LawPath&) = delete;
  LawPath& operator=(const LawPath&) = delete;
  ~LawPath() = default;

  /// Adds the state itself as a waypoint. Requires slope 0.
  void add_begin() noexcept { add(end_); }
  /// Adds the end of the next piece, which leads to this rate. Requires room for it.
  void add_piece(double end_rate, Time length) noexcept {
    add(end_of_piece(end_, end_rate, length));
  }
  /// Adds the end of the straight line, after the last piece.
  void add_line() noexcept { add_piece(end_.rate, kLawLine); }

  /// The waypoints so far: views, valid as long as this object.
  [[nodiscard]] std::span<const Waypoint> waypoints() const noexcept {
    return std::span(waypoints_).first(count_);
  }

 private:
  static constexpr std::size_t kMost = RateCurve::kMostPieces + 1;

  void add(const LawState& state) noexcept {
    end_ = state;
    values_[count_] = {state.position, state.rate, 0};
    const auto values = std::span<const double>(values_[count_]);
    waypoints_[count_] = {.time = state.time,
                          .position = values.first(1),
                          .velocity = values.subspan(1, 1),
                          .acceleration = values.last(1)};
    ++count_;
  }

  LawState end_;
  std::array<std::array<double, 3>, kMost> values_{};
  std::array<Waypoint, kMost> waypoints_{};
  std::size_t count_ = 0;
};

}  // namespace splinecast::core
