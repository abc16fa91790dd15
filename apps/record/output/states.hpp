#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "ipc/board/segment.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Samples the settled curve of a stream at a rate, with the bits of a reader: at the multiples of
/// an interval. One thread uses it.
class States {
 public:
  /// `hz`: 1e-3 to 1e5.
  States(const ipc::RegionHeader& header, double hz);

  using Take = std::function<void(Time time, const State& state)>;
  /// Samples within [left, right) of the next settled segment, at most kMost times. After a hold
  /// that is longer than that, continues with the next segment.
  void sample(const ipc::SegmentCopy& segment, const Take& take);

  static constexpr std::int64_t kMost = 1'000'000;

 private:
  DimensionKinds kinds_;
  Time interval_;
  State state_;
};

}  // namespace splinecast::apps::record
