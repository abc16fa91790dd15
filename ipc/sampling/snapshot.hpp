#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"

namespace splinecast::ipc {

/// Several segments of one revision: a consistent piece of the curve, whole or not at all.
class BoardSnapshot {
 public:
  /// Allocates as it grows; reuse one to allocate no more.
  explicit BoardSnapshot(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] const Head& head() const noexcept { return head_; }

  /// The segments, oldest first.
  [[nodiscard]] std::span<const SegmentCopy> segments() const noexcept {
    return std::span(segments_).first(size_);
  }

 private:
  friend class Sampler;
  std::size_t dimensions_;
  Head head_;
  std::size_t size_ = 0;
  std::vector<SegmentCopy> segments_;
};

}  // namespace splinecast::ipc
