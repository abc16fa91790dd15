#pragma once

#include <string>

#include "apps/trials/curve_watch.hpp"
#include "ipc/sampling/snapshot.hpp"
#include "splinecast/reader.hpp"
#include "tests/campaign/kills/plan.hpp"

namespace splinecast::campaign {

/// What one reader checks of a stream's curve, counted in its facts; what it finds it says on
/// standard error. One thread uses it; it lives as long as its reader is attached.
class CurveCheck {
 public:
  /// All outlive the check, which is the reader's only user.
  CurveCheck(const Plan& plan, Reader& reader, ReaderFacts& facts);

  /// Samples at t as a controller does, t never going back: the sample is of one version, what was
  /// settled reads as it did, and nothing steps between t and the tick before.
  SampleStatus tick(Time t);

  /// Samples at t, anywhere: of one version, whatever its status.
  SampleStatus peek(Time t);

  /// Copies all segments between two times: each is of one version, begins at its waypoint, joins
  /// the one before, and is, once settled, the one that it must be; the newest one ends at rest.
  void survey(Time from, Time to);

 private:
  void check_state(const State& state, Time t);
  void check_segment(const ipc::SegmentCopy& segment);
  void check_join(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after);
  void check_end(const ipc::SegmentCopy& segment);
  void check_reference(const ipc::SegmentCopy& segment);
  void check_steps(const apps::WatchReport& before, Time t);
  void found(std::atomic<std::uint64_t>& counter, const std::string& what);

  const Plan* plan_;
  Reader* reader_;
  ReaderFacts* facts_;
  apps::CurveWatch watch_;
  State state_;
  State left_;
  State right_;
  ipc::BoardSnapshot snapshot_;
};

}  // namespace splinecast::campaign
