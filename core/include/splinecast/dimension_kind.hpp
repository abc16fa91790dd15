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

/// What a dimension's values are, and what that asks of a curve.
///
/// A curve is solved through numbers. Where several numbers stand for the same thing, as an angle
/// and that angle a turn later do, or a quaternion and its negative, each waypoint is first moved
/// to the *representative* nearest to the waypoint before; and what is read off the curve is put
/// back into one form: an angle into [−P/2, P/2), a quaternion to unit length.
namespace [[gnu::visibility("default")]] splinecast {

enum class DimensionKind : std::uint8_t {
  linear = 0,
  wrap = 1,             ///< values repeat with a period: the curve takes the short way
  quaternion = 2,       ///< one of four consecutive dimensions: a rotation as x y z w
  quaternion_wxyz = 3,  ///< likewise, as w x y z
};
inline constexpr std::uint8_t kDimensionKinds = 4;

/// Dimensions that a quaternion takes.
inline constexpr std::size_t kQuaternionSize = 4;

/// The kind of one dimension; all four of a quaternion have the same.
struct Dimension {
  DimensionKind kind = DimensionKind::linear;
  double period = 0;  ///< of `wrap`, in the dimension's unit: kLeastPeriod … kLargestValue; else 0

  friend bool operator==(const Dimension&, const Dimension&) = default;
};
inline constexpr double kLeastPeriod = 1e-100;

/// How a kind is written on a command line: `linear`, `wrap:PERIOD`, `quaternion`,
/// `quaternion-wxyz`.
[[nodiscard]] std::string to_string(const Dimension& dimension);

/// Reads what to_string writes. Returns nothing for any other text; a period out of range is one.
[[nodiscard]] std::optional<Dimension> parse_dimension(std::string_view text);

/// Four consecutive dimensions that hold a quaternion.
struct QuaternionDimensions {
  std::size_t first = 0;
  bool w_first = false;  ///< w x y z, else x y z w
};

/// A waypoint's values, to be moved. An empty span says "not given".
struct WaypointValues {
  std::span<double> position;
  std::span<double> velocity{};
  std::span<double> acceleration{};
};

/// The kinds of all dimensions of a curve. Allocates when made only; its functions are O(D),
/// allocate and throw nothing unless they say so, and are safe from any thread.
class DimensionKinds {
 public:
  /// All linear, however many dimensions there are.
  DimensionKinds() = default;

  /// One kind per dimension, in order. Throws std::invalid_argument, naming dimension and value,
  /// for a period out of range, a period of what does not wrap, or a quaternion of other than four
  /// dimensions.
  explicit DimensionKinds(std::span<const Dimension> dimensions);

  /// Whether there is nothing to be done for any dimension.
  [[nodiscard]] bool all_linear() const noexcept { return wraps_.empty() && quaternions_.empty(); }

  [[nodiscard]] std::span<const QuaternionDimensions> quaternions() const noexcept {
    return quaternions_;
  }

  /// Whether every quaternion of a position, or this one, has a length that gives a rotation:
  /// between 1e-100 and 1e100.
  [[nodiscard]] bool takes(std::span<const double> position) const noexcept;
  [[nodiscard]] static bool takes(std::span<const double> position,
                                  const QuaternionDimensions& quaternion) noexcept;

  /// Moves a waypoint to the representative nearest to `previous`, the position before it on the
  /// curve: a wrapping value by whole periods, to within half of one; a quaternion to unit length,
  /// with the sign that has no negative dot product with the one before. Given derivatives of a
  /// quaternion are scaled with it. An empty `previous` says that there is none: then values keep
  /// their sign and period. Values must be usable, and such as `takes` accepts; the derivatives of
  /// a short quaternion may leave the range of what is usable.
  void continue_from(std::span<const double> previous,
                     const WaypointValues& waypoint) const noexcept;

  /// Puts what was evaluated on a curve into the form in which it is read: wrapping positions into
  /// [−P/2, P/2); of a quaternion q the position, velocity, acceleration and jerk of q/|q|. A
  /// quaternion whose length is no number from 1e-100 to 1e100 is left as it is.
  void normalise(const StateRef& state) const noexcept;

  /// The part of `normalise` that concerns quaternions, without jerk: for a state that a curve is
  /// to go on from. Wrapping positions stay where the curve has them.
  void normalise_quaternions(std::span<double> position, std::span<double> velocity,
                             std::span<double> acceleration) const noexcept;

  /// Turns the acceleration step of a curve where it passes `position` into that of what
  /// `normalise` gives, which is what readers see: of q/|q|. The curve's position and velocity do
  /// not step there.
  void normalise_step(std::span<const double> position, std::span<double> step) const noexcept;

  /// Throws std::invalid_argument if an end condition asks for a velocity or an acceleration other
  /// than 0 in a quaternion's dimensions: which sign the curve has there depends on all waypoints.
  void require_end(const Condition& end) const;

 private:
  struct Wrap {
    std::size_t dimension;
    double period;
  };
  std::vector<Wrap> wraps_;
  std::vector<QuaternionDimensions> quaternions_;
};

using Vector3 = std::array<double, 3>;

/// How a rotation moves: in the body's frame, if the quaternion takes body coordinates to those of
/// the world. This is what a gyroscope on the body measures.
struct AngularMotion {
  Vector3 velocity{};      ///< ω = 2·vec(q*⊗q̇), rad/s
  Vector3 acceleration{};  ///< α = 2·vec(q*⊗q̈), rad/s²
};

/// The angular motion of a quaternion and its derivatives at unit length, as `normalise` leaves
/// them in a state's spans.
[[nodiscard]] AngularMotion angular_motion(const QuaternionDimensions& at,
                                           std::span<const double> position,
                                           std::span<const double> velocity,
                                           std::span<const double> acceleration) noexcept;

}  // namespace splinecast
