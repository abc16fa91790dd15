#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/limits/extremes.hpp"

namespace splinecast::core {

/// The range of positions of a part of a curve, per dimension. Allocates only in its constructor.
class PositionRange {
 public:
  explicit PositionRange(std::size_t dimensions) : least_(dimensions), greatest_(dimensions) {}

  /// Begins again, with one position.
  void restart(std::span<const double> position) noexcept;

  /// Adds the range of a part of a segment. O(D).
  void add(const SegmentPart& part) noexcept;

  [[nodiscard]] std::span<const double> least() const noexcept { return least_; }
  [[nodiscard]] std::span<const double> greatest() const noexcept { return greatest_; }

 private:
  std::vector<double> least_;
  std::vector<double> greatest_;
};

}  // namespace splinecast::core
