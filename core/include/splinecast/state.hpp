#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace [[gnu::visibility("default")]] splinecast {

/// Minimum and maximum number of dimensions of a stream.
inline constexpr std::size_t kMinDimensions = 1;
inline constexpr std::size_t kMaxDimensions = 64;

/// The output of a sample: position [unit], velocity [unit/s], acceleration [unit/s²] and jerk
/// [unit/s³], one value per dimension in each span. Does not own its memory.
struct StateRef {
  std::span<double> position;
  std::span<double> velocity;
  std::span<double> acceleration;
  std::span<double> jerk;
};

/// A state that owns its memory. Only the constructor allocates; one object can be used for any
/// number of samples.
class State {
 public:
  /// Makes a zero state of `dimensions` values per derivative.
  explicit State(std::size_t dimensions) : dimensions_(dimensions), values_(4 * dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::span<const double> position() const noexcept { return part(0); }
  [[nodiscard]] std::span<const double> velocity() const noexcept { return part(1); }
  [[nodiscard]] std::span<const double> acceleration() const noexcept { return part(2); }
  [[nodiscard]] std::span<const double> jerk() const noexcept { return part(3); }

  /// All 4·D values: positions, velocities, accelerations, jerks.
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }

  /// The memory of this state, for an evaluation to write to.
  [[nodiscard]] StateRef ref() noexcept {
    const std::span<double> all(values_);
    return {all.subspan(0, dimensions_), all.subspan(dimensions_, dimensions_),
            all.subspan(2 * dimensions_, dimensions_), all.subspan(3 * dimensions_, dimensions_)};
  }

 private:
  [[nodiscard]] std::span<const double> part(std::size_t derivative) const noexcept {
    return std::span<const double>(values_).subspan(derivative * dimensions_, dimensions_);
  }

  std::size_t dimensions_;
  std::vector<double> values_;
};

/// A set of derivatives to evaluate. Values of several derivatives are stored in this order. The
/// bit of the r-th derivative is 1 << r.
enum class Derivatives : std::uint8_t {
  none = 0,
  position = 1,
  velocity = 2,
  acceleration = 4,
  jerk = 8,
  all = 15,
};

[[nodiscard]] constexpr Derivatives operator|(Derivatives a, Derivatives b) noexcept {
  return static_cast<Derivatives>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}

/// Whether `set` has all of `wanted`.
[[nodiscard]] constexpr bool contains(Derivatives set, Derivatives wanted) noexcept {
  return (set | wanted) == set;
}

/// Number of derivatives in the set: 0 … 4.
[[nodiscard]] constexpr std::size_t count(Derivatives set) noexcept {
  return static_cast<std::size_t>(std::popcount(static_cast<std::uint8_t>(set)));
}

}  // namespace splinecast
