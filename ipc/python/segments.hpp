#pragma once

#include "splinecast/snapshot.hpp"

namespace splinecast::python {

/// The Python class Snapshot.
struct Segments {
  explicit Segments(std::size_t dimensions) : snapshot(dimensions) {}

  Snapshot snapshot;
  SampleStatus status = SampleStatus::no_data;
};

}  // namespace splinecast::python
