#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/structs.hpp"
#include "splinecast/snapshot.hpp"

namespace splinecast::ipc {

inline void require_segment(std::size_t i, std::size_t segments) {
  if (i < segments) return;
  refuse("i",
         "is " + std::to_string(i) + ", and there are " + std::to_string(segments) + " segments");
}

/// Writes a segment of `dimensions` dimensions to the struct of a C program.
inline void put_segment(const SnapshotSegment& segment, std::size_t dimensions,
                        splinecast_segment* out) {
  const auto vector_of = [](std::span<const double> values) -> splinecast_vector {
    if (values.empty()) return {nullptr, 0, 0};
    return {values.data(), values.size(), 1};
  };
  const auto width = static_cast<std::ptrdiff_t>(dimensions);
  write_struct(splinecast_segment{.size = sizeof(splinecast_segment),
                                  .left = segment.left.count(),
                                  .right = segment.right.count(),
                                  .order = segment.order,
                                  .kind = static_cast<int>(segment.kind),
                                  .coefficients = {segment.coefficients.data(),
                                                   static_cast<std::size_t>(segment.order),
                                                   dimensions, width, 1},
                                  .waypoint = vector_of(segment.waypoint),
                                  .acceleration_step = vector_of(segment.acceleration_step),
                                  .is_corner = segment.is_corner ? 1 : 0,
                                  .reserved = 0},
               out);
}

}  // namespace splinecast::ipc
