#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string_view>
#include <vector>

#include "apps/output/stream.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Writes samples as CSV: `t_ns,p[0],…,v[0],…,a[0],…,j[0],…`, then `omega[0],…,alpha[0],…`, three
/// of each per quaternion. Numbers have the shortest form that reads back exactly.
class SampleWriter {
 public:
  /// Writes the header. `further` has the names of columns at the end, separated by commas.
  SampleWriter(Output& output, std::size_t dimensions, DimensionKinds kinds,
               std::string_view further = {});

  /// Writes a row. `state` is normalised, as from a reader. `further` has the cells of the further
  /// columns, separated by commas.
  void write(Time time, const State& state, std::string_view further = {});

 private:
  Output* output_;
  DimensionKinds kinds_;
  std::vector<AngularMotion> motions_;  ///< of the quaternions
  fmt::memory_buffer line_;
};

}  // namespace splinecast::apps
