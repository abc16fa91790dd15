#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace [[gnu::visibility("default")]] splinecast {

/// A boundary condition at the first or the last waypoint of a spline. `own` is the default of the
/// method: natural for `c2`, `smoothing`, `normalized` and `rounded`, but a full stop at the end of
/// a `c2` stream; the values given with the waypoint for `hermite` and `quintic`; a slope by the
/// method's rule for the other local methods.
enum class ConditionKind {
  natural,       ///< acceleration 0
  clamped,       ///< velocity 0
  halt,          ///< velocity and acceleration 0 (full stop), by an order-6 end segment
  velocity,      ///< given velocity
  acceleration,  ///< given acceleration
  not_a_knot,    ///< third derivative continuous at the next knot; `c2` batch only
  periodic,      ///< both ends joined: required at start and end together; `c2` batch only
  own,           ///< the default of the method
};

/// Whether a condition can be met online, while waypoints arrive.
[[nodiscard]] constexpr bool is_online(ConditionKind kind) noexcept {
  return kind <= ConditionKind::acceleration || kind == ConditionKind::own;
}

/// A condition and, for `velocity` [unit/s] and `acceleration` [unit/s²], one value per dimension.
struct Condition {
  ConditionKind kind = ConditionKind::natural;
  std::vector<double> value{};

  friend bool operator==(const Condition&, const Condition&) = default;
};

/// The boundary condition at the newest knot while a stream continues.
enum class Tail {
  bessel,     ///< slope of the parabola through the last three waypoints
  parabolic,  ///< the last segment has no cubic term
  natural,    ///< acceleration 0
  clamped,    ///< velocity 0
};

/// Whether a curve that ends with this condition is at rest there, for any waypoints.
[[nodiscard]] constexpr bool is_at_rest(ConditionKind kind) noexcept {
  return kind == ConditionKind::clamped || kind == ConditionKind::halt;
}

/// The text of a condition on a command line: `natural`, `clamped`, `halt`, `velocity=1,2,3`,
/// `acceleration=1,2,3`, `not-a-knot`, `periodic`; and `own`, the default when none is given.
[[nodiscard]] std::string to_string(const Condition& condition);
[[nodiscard]] std::string_view to_string(Tail tail) noexcept;

/// Reads usable values (is_usable) separated by commas: `1,-2.5,0`. Returns nothing for other text.
[[nodiscard]] std::optional<std::vector<double>> parse_values(std::string_view text);

/// Reads what to_string writes, except `own`. Returns nothing for any other text, such as a name
/// without its values, a value that is not usable, or values after a name that takes none.
[[nodiscard]] std::optional<Condition> parse_condition(std::string_view text);
[[nodiscard]] std::optional<Tail> parse_tail(std::string_view text) noexcept;

/// Throws std::invalid_argument, naming the counts, unless the condition has one usable value per
/// dimension if its kind takes values, and no value otherwise.
void require_values(const Condition& condition, std::size_t dimensions);

}  // namespace splinecast
