#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"

namespace splinecast::campaign::ends {

/// Maximum number of dimensions of a life.
inline constexpr std::size_t kMostDimensions = 6;

/// A segment of a published curve.
struct Piece {
  ipc::Word number = 0;
  Time left{};
  Time right{};
  Time natural_right{};  ///< where it would end if it had not been cut
  int order = 0;
  SegmentKind kind{};
  bool is_corner = false;  ///< it begins at rest, although the piece before it moves
  std::array<double, kMaxOrder * kMostDimensions> coefficients{};  ///< [power][dimension]

  [[nodiscard]] double seconds() const noexcept { return to_seconds(right - left); }
};

/// The extremes of a polynomial, to 10⁻⁷ of its size.
struct Range {
  double least = 0;
  double greatest = 0;
  [[nodiscard]] double size() const noexcept { return std::max(-least, greatest); }
};

/// Evaluates pieces of D dimensions by their Bernstein coefficients, which bound a polynomial from
/// outside. Shares no code with the solver.
class PieceRanges {
 public:
  PieceRanges(std::size_t dimensions, const DimensionKinds& kinds)
      : dimensions_(dimensions), kinds_(&kinds) {}

  /// The value of a derivative at u seconds after the left end.
  [[nodiscard]] double value(const Piece& piece, std::size_t d, int derivative,
                             double u) const noexcept;

  /// The extremes of a derivative of a linear or periodic dimension from u = `from` to the end.
  [[nodiscard]] Range range(const Piece& piece, std::size_t d, int derivative,
                            double from = 0) const noexcept;

  /// Σ |c_k k!/(k−m)! u^(k−m)| at the right end: the scale of rounding errors.
  [[nodiscard]] double scale(const Piece& piece, std::size_t d, int derivative) const noexcept;

  /// The largest |ω| or |α| of the quaternion whose first dimension is d, at 17 times.
  [[nodiscard]] double turn(const Piece& piece, const QuaternionDimensions& q,
                            int derivative) const noexcept;

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return *kinds_; }
  [[nodiscard]] bool is_rotation(std::size_t d) const noexcept;

 private:
  std::size_t dimensions_;
  const DimensionKinds* kinds_;
};

/// How far a piece goes beyond the limits: for each dimension and derivative 1 to 3, the peak
/// without its rounding error divided by the limit; 0 without a limit. Of a rotation only velocity
/// and acceleration, in its first dimension.
struct Peaks {
  std::array<std::array<double, 3>, kMostDimensions> ratio{};
  std::array<Range, kMostDimensions> position{};  ///< of linear dimensions
};
[[nodiscard]] Peaks peaks_of(const PieceRanges& ranges, const Piece& piece,
                             const MotionLimits& limits, double from = 0) noexcept;

}  // namespace splinecast::campaign::ends
