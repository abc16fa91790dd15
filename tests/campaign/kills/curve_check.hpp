#pragma once

#include <string>

#include "apps/trials/curve_watch.hpp"
#include "ipc/sampling/snapshot.hpp"
#include "splinecast/reader.hpp"
#include "tests/campaign/kills/plan.hpp"

namespace splinecast::campaign {

/// The checks of one reader on a stream's curve. Counts violations in `facts` and prints them to
/// standard error. Not thread-safe. Lives as long as its reader is attached.
class CurveCheck {
 public:
  /// All arguments outlive the check, which is the only user of `reader`.
  CurveCheck(const Plan& plan, Reader& reader, ReaderFacts& facts);

  /// Samples at t like a controller; t never decreases. Checks that the sample is not torn, that
  /// settled samples keep their values, and that since the previous tick position and velocity have
  /// no step and the acceleration has no unpublished step.
  SampleStatus tick(Time t);

  /// Samples at any t. Checks that the sample is not torn.
  SampleStatus peek(Time t);

  /// Copies all segments between two times. Checks that each one is not torn, begins at its
  /// waypoint, joins the one before, and equals its reference once settled, and that the newest one
  /// ends at rest.
  void survey(Time from, Time to);

 private:
  void check_state(const State& state, Time t);
  void check_segment(const ipc::SegmentCopy& segment);
  [[nodiscard]] bool begins_at_waypoint(const ipc::SegmentCopy& segment) const;
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
