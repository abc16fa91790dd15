#pragma once

#include <string>

#include "ipc/board/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"

namespace splinecast::campaign {

/// What holds of the segments of one curve, up to rounding: of what is added up to evaluate them,
/// in each dimension, nothing may be off by more than kRounding.
class CurveRules {
 public:
  static constexpr double kRounding = 1e-10;

  explicit CurveRules(const DimensionKinds& kinds, std::size_t dimensions)
      : kinds_(&kinds), left_(dimensions), right_(dimensions) {}

  /// By how much more than rounding position and velocity step where `after` follows `before`; at
  /// most 1 is right. Quaternions are compared at unit length.
  struct Step {
    double position = 0;
    double velocity = 0;
  };
  [[nodiscard]] Step step(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after);

  /// Whether a segment is at rest at its end; with `halts` also without acceleration.
  [[nodiscard]] bool ends_at_rest(const ipc::SegmentCopy& segment, bool halts);

  /// Whether a segment begins, or at `at_end` ends, at a waypoint's position.
  [[nodiscard]] bool passes(const ipc::SegmentCopy& segment, bool at_end,
                            std::span<const double> position, std::span<const Dimension> of);

 private:
  const DimensionKinds* kinds_;
  State left_;
  State right_;
};

}  // namespace splinecast::campaign
