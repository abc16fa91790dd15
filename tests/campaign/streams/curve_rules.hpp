#pragma once

#include <string>

#include "ipc/board/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"

namespace splinecast::campaign {

/// Rules for the segments of one curve. The tolerance in each dimension is kRounding times the sum
/// of the absolute values of the terms of the evaluated polynomial.
class CurveRules {
 public:
  static constexpr double kRounding = 1e-10;

  explicit CurveRules(const DimensionKinds& kinds, std::size_t dimensions)
      : kinds_(&kinds), left_(dimensions), right_(dimensions) {}

  /// Steps of position and velocity from `before` to `after`, divided by the tolerance; up to 1 is
  /// correct. Quaternions are compared at unit length.
  struct Step {
    double position = 0;
    double velocity = 0;
  };
  [[nodiscard]] Step step(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after);

  /// Whether a segment ends with velocity 0, and with `halts` also with acceleration 0.
  [[nodiscard]] bool ends_at_rest(const ipc::SegmentCopy& segment, bool halts);

  /// Whether a segment begins, or with `at_end` ends, at a waypoint's position.
  [[nodiscard]] bool passes(const ipc::SegmentCopy& segment, bool at_end,
                            std::span<const double> position, std::span<const Dimension> of);

 private:
  const DimensionKinds* kinds_;
  State left_;
  State right_;
};

}  // namespace splinecast::campaign
