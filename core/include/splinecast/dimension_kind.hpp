#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/state.hpp"

/// The kinds of dimensions: linear, periodic and quaternion.
///
/// Some values have several representations: an angle and the same angle plus a turn, or a
/// quaternion and its negative. Before the solve, each waypoint is unwrapped: moved to the
/// *representative* nearest to the previous waypoint. Values read from the curve are normalised: an
/// angle into [−P/2, P/2), a quaternion to unit length.
namespace [[gnu::visibility("default")]] splinecast {

enum class DimensionKind : std::uint8_t {
  linear = 0,
  periodic = 1,         ///< values repeat with a period; the curve takes the shorter way
  quaternion = 2,       ///< one of four consecutive dimensions: a rotation as x y z w
  quaternion_wxyz = 3,  ///< the same, as w x y z
};
inline constexpr std::uint8_t kDimensionKinds = 4;

/// Number of dimensions of a quaternion.
inline constexpr std::size_t kQuaternionSize = 4;

/// The kind of one dimension; the four dimensions of a quaternion have the same kind.
struct Dimension {
  DimensionKind kind = DimensionKind::linear;
  double period =
      0;  ///< of `periodic`, in the dimension's unit: kLeastPeriod … kLargestValue; else 0

  friend bool operator==(const Dimension&, const Dimension&) = default;
};
inline constexpr double kLeastPeriod = 1e-100;

/// The text of a kind on a command line: `linear`, `periodic:PERIOD`, `quaternion`,
/// `quaternion-wxyz`.
[[nodiscard]] std::string to_string(const Dimension& dimension);

/// Reads what to_string writes. Returns nothing for any other text or a period out of range.
[[nodiscard]] std::optional<Dimension> parse_dimension(std::string_view text);

/// Four consecutive dimensions that hold a quaternion.
struct QuaternionDimensions {
  std::size_t first = 0;
  bool w_first = false;  ///< w x y z, else x y z w
};

/// The values of a waypoint, changed in place. An empty span means "not given".
struct WaypointValues {
  std::span<double> position;
  std::span<double> velocity{};
  std::span<double> acceleration{};
};

/// The kinds of all dimensions of a curve. Only the constructor allocates. Functions are O(D), do
/// not allocate or throw unless documented, and are safe from any thread.
class DimensionKinds {
 public:
  /// All linear, for any number of dimensions.
  DimensionKinds() = default;

  /// One kind per dimension, in order. Throws std::invalid_argument, naming dimension and value,
  /// for a period out of range, a period of a kind other than `periodic`, or a quaternion that does
  /// not have four dimensions.
  explicit DimensionKinds(std::span<const Dimension> dimensions);

  /// Whether all dimensions are linear.
  [[nodiscard]] bool all_linear() const noexcept {
    return periodic_.empty() && quaternions_.empty();
  }

  [[nodiscard]] std::span<const QuaternionDimensions> quaternions() const noexcept {
    return quaternions_;
  }

  /// Whether every quaternion of a position, or the given one, has a valid length: between 1e-100
  /// and 1e100.
  [[nodiscard]] bool takes(std::span<const double> position) const noexcept;
  [[nodiscard]] static bool takes(std::span<const double> position,
                                  const QuaternionDimensions& quaternion) noexcept;

  /// Moves a waypoint to the representative nearest to `previous`, the position before it on the
  /// curve. Unwraps a periodic value by whole periods, to within half a period. Scales a quaternion
  /// to unit length, with the sign for which its dot product with the previous one is not negative;
  /// scales its given derivatives by the same factor. If `previous` is empty, signs and periodic
  /// values do not change. Values must be usable, and `takes` must accept the position; the
  /// derivatives of a short quaternion may exceed the usable range.
  void continue_from(std::span<const double> previous,
                     const WaypointValues& waypoint) const noexcept;

  /// Normalises a state that was evaluated on a curve: wraps periodic positions into [−P/2, P/2),
  /// and replaces position, velocity, acceleration and jerk of a quaternion q by those of q/|q|.
  /// Does not change a quaternion whose length is NaN or not between 1e-100 and 1e100.
  void normalise(const StateRef& state) const noexcept;

  /// Normalises quaternions only, without jerk: for a state from which a curve continues. Periodic
  /// positions stay unwrapped.
  void normalise_quaternions(std::span<double> position, std::span<double> velocity,
                             std::span<double> acceleration) const noexcept;

  /// Converts the acceleration step of a curve at `position` to the step after `normalise`, which
  /// readers see: that of q/|q|. The position and velocity of the curve must not step there.
  void normalise_step(std::span<const double> position, std::span<double> step) const noexcept;

  /// Throws std::invalid_argument if an end condition has a velocity or an acceleration other than
  /// 0 in a dimension of a quaternion: the sign of the quaternion there depends on all waypoints.
  void require_end(const Condition& end) const;

 private:
  struct Wrap {
    std::size_t dimension;
    double period;
  };
  std::vector<Wrap> periodic_;
  std::vector<QuaternionDimensions> quaternions_;
};

using Vector3 = std::array<double, 3>;

/// Angular velocity and acceleration in the body frame, if the quaternion maps body coordinates to
/// world coordinates. A gyroscope on the body measures this velocity.
struct AngularMotion {
  Vector3 velocity{};      ///< ω = 2·vec(q*⊗q̇), rad/s
  Vector3 acceleration{};  ///< α = 2·vec(q*⊗q̈), rad/s²
};

/// The angular motion of a unit quaternion and its derivatives, as `normalise` writes them.
[[nodiscard]] AngularMotion angular_motion(const QuaternionDimensions& at,
                                           std::span<const double> position,
                                           std::span<const double> velocity,
                                           std::span<const double> acceleration) noexcept;

}  // namespace splinecast
