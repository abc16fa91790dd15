#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "core/forms/stop.hpp"
#include "splinecast/time.hpp"

/// How a curve ends, relative to its *target*, the spline through the waypoints of a run. The
/// states at the ends of entries are kept beside it: their size is known only at run time.
namespace splinecast::core {

/// The curve follows the target: after the newest waypoint comes its stop.
struct OnTarget {};

/// The curve ends in a stop, or rests: only an entry leads to the target.
struct Waiting {
  bool is_searching = false;  ///< for that entry
};

/// An entry ends at a waypoint of the run, and the target follows.
struct Entering {
  Time end{};             ///< of the entry
  std::size_t known = 0;  ///< number of waypoints that the entry used
};

/// The times of the motion after an entry that ends ahead of the newest waypoint: the remainder of
/// the straight line, unless the entry ends after the line, and the stop.
struct AfterEntry {
  Time end{};       ///< of the entry
  Time line_end{};  ///< of the line
  Time rest{};      ///< end of the stop

  [[nodiscard]] bool has_line() const noexcept { return end < line_end; }
  [[nodiscard]] Time stop_begin() const noexcept { return has_line() ? line_end : end; }
  [[nodiscard]] Time stop_length() const noexcept {
    return std::max(rest - stop_begin(), kLeastStopTime);
  }

  /// Writes the position at the end of the line.
  void write_line_end(std::span<const double> position, std::span<const double> velocity,
                      std::span<double> out) const noexcept {
    const double line = to_seconds(line_end - end);
    for (std::size_t d = 0; d < out.size(); ++d) out[d] = position[d] + line * velocity[d];
  }
};

/// An entry ends at the time of the newest waypoint or later, and a stop follows.
struct EnteringAhead {
  AfterEntry after{};
  std::size_t known = 0;       ///< number of waypoints that the entry used
  bool ends_at_known = false;  ///< it ends at waypoint known - 1, which the curve has not met yet
  bool is_searching = false;   ///< for another entry, because newer waypoints are known
};

/// The curve rests at the first waypoint of a stream, until it is decided how it starts.
struct Starting {};

/// How a finished curve ends.
enum class EndKind : std::uint8_t {
  none = 0,          ///< it is not finished, or a solver of an earlier version finished it
  as_requested = 1,  ///< at its last waypoint, with the requested condition, or where it rested
  slowed = 2,        ///< at its last waypoint, by slowing down on its path
  entered = 3,       ///< by an entry that comes to rest at the last waypoint
  stopped = 4,       ///< in the stop after the last waypoint: no entry kept the limits
  in_stop = 5,       ///< in the published stop: no entry to the last waypoint kept the limits
};

/// How a curve has been ended, beside the end that it had then.
struct Ended {
  EndKind kind{};
  Time rest{};  ///< `slowed`, `entered`, `stopped`: when the curve comes to rest
};

using End = std::variant<OnTarget, Waiting, Entering, EnteringAhead, Starting>;

template <typename T>
[[nodiscard]] constexpr bool is(const End& end) noexcept {
  return std::holds_alternative<T>(end);
}

/// Whether the curve ends with a piece of the target.
[[nodiscard]] constexpr bool is_on_target(const End& end) noexcept {
  return is<OnTarget>(end) || is<Entering>(end);
}

/// Whether the end waits for an entry, or for a better one.
[[nodiscard]] constexpr bool may_enter(const End& end) noexcept {
  return is<Waiting>(end) || is<EnteringAhead>(end);
}

[[nodiscard]] constexpr bool is_searching(const End& end) noexcept {
  const auto* const waiting = std::get_if<Waiting>(&end);
  const auto* const ahead = std::get_if<EnteringAhead>(&end);
  return (waiting != nullptr && waiting->is_searching) || (ahead != nullptr && ahead->is_searching);
}

/// Begins or ends the search of an end that may_enter(); changes no other.
constexpr void set_searching(End& end, bool is_searching) noexcept {
  if (auto* const waiting = std::get_if<Waiting>(&end)) waiting->is_searching = is_searching;
  if (auto* const ahead = std::get_if<EnteringAhead>(&end)) ahead->is_searching = is_searching;
}

}  // namespace splinecast::core
