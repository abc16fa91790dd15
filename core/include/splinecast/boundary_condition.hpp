#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace [[gnu::visibility("default")]] splinecast {

/// What holds at the first or the last waypoint of a spline. `own`, what the method does when
/// nothing is asked for, is natural for `c2`, `smoothing`, `normalized` and `rounded`, but a halt
/// where a stream of `c2` ends; what the waypoints give for `hermite` and `quintic`; a slope by the
/// method's rule for the other local methods.
enum class ConditionKind {
  natural,       ///< acceleration 0
  rest,          ///< velocity 0
  halt,          ///< velocity and acceleration 0, by an order-6 end segment
  velocity,      ///< given velocity ("clamped")
  acceleration,  ///< given acceleration
  not_a_knot,    ///< third derivative continuous at the next knot; `c2` at once only
  periodic,      ///< both ends joined: start and end must both be it; `c2` at once only
  own,           ///< what the method itself does
};

/// Whether a condition can be met while waypoints come.
[[nodiscard]] constexpr bool is_online(ConditionKind kind) noexcept {
  return kind <= ConditionKind::acceleration || kind == ConditionKind::own;
}

/// A condition and, for `velocity` [unit/s] and `acceleration` [unit/s²], one value per dimension.
struct Condition {
  ConditionKind kind = ConditionKind::natural;
  std::vector<double> value{};

  friend bool operator==(const Condition&, const Condition&) = default;
};

/// The condition at the newest knot while a stream goes on.
enum class Tail {
  bessel,     ///< slope of the parabola through the last three waypoints
  parabolic,  ///< the last segment has no cubic term
  natural,    ///< acceleration 0
  rest,       ///< velocity 0
};

/// Whether a curve that ends with this condition is at rest there, whatever its waypoints.
[[nodiscard]] constexpr bool is_at_rest(ConditionKind kind) noexcept {
  return kind == ConditionKind::rest || kind == ConditionKind::halt;
}

/// How a condition is written on a command line: `natural`, `rest`, `halt`, `velocity=1,2,3`,
/// `acceleration=1,2,3`, `not-a-knot`, `periodic`; and `own`, which is what saying nothing means.
[[nodiscard]] std::string to_string(const Condition& condition);
[[nodiscard]] std::string_view to_string(Tail tail) noexcept;

/// Numbers that are usable as values, separated by commas: `1,-2.5,0`.
[[nodiscard]] std::optional<std::vector<double>> parse_values(std::string_view text);

/// Reads what to_string writes, but for `own`. Returns nothing for any other text; a name without
/// its values, a value that is not a finite number and values behind a name that takes none are
/// other texts.
[[nodiscard]] std::optional<Condition> parse_condition(std::string_view text);
[[nodiscard]] std::optional<Tail> parse_tail(std::string_view text) noexcept;

/// Throws std::invalid_argument, naming the counts, unless the condition carries one finite value
/// per dimension where its kind takes values, and none where it takes none.
void require_values(const Condition& condition, std::size_t dimensions);

}  // namespace splinecast
