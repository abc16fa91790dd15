#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ipc/sampling/sampler.hpp"

namespace splinecast::apps {

/// The findings of a watch. Steps are absolute, in the stream's units.
struct WatchReport {
  std::uint64_t samples = 0;
  std::array<std::uint64_t, kSampleStatuses> by_status{};
  std::uint64_t changed = 0;     ///< samples whose values changed later, without `revised`
  std::uint64_t unsettled = 0;   ///< samples in motion that had not settled at their instant
  std::uint64_t knots = 0;       ///< joins between segments that were compared
  double position_step = 0;      ///< largest at a join
  double velocity_step = 0;      ///< largest at a join
  double unpublished_step = 0;   ///< largest difference of actual and published acceleration step
  double acceleration_step = 0;  ///< largest published acceleration step
  double acceleration = 0;       ///< largest sampled acceleration
};

/// Whether a motion of joint angles in rad had no forbidden step and no forbidden change.
[[nodiscard]] bool is_sound(const WatchReport& report) noexcept;

/// Samples a live curve as a controller does, and checks that every sample reads the same later,
/// that position and velocity never step, and that every acceleration step is the published one.
/// Not thread-safe.
class CurveWatch {
 public:
  /// `sampler` outlives the watch, which is its only user.
  explicit CurveWatch(ipc::Sampler& sampler, std::size_t dimensions);

  /// Samples at `now` and checks everything since the tick before. Returns the sample's status.
  SampleStatus tick(Time now);

  /// The last sample; valid if its status has values.
  [[nodiscard]] const State& state() const noexcept { return now_; }
  [[nodiscard]] const WatchReport& report() const noexcept { return report_; }

 private:
  /// Ticks whose samples are kept to be read again.
  static constexpr std::size_t kKept = 256;
  struct Seen {
    Time time{};
    std::vector<double> values;
  };

  void read_again(std::size_t back);
  void check_joins(Time from, Time to);
  void evaluate(const ipc::SegmentCopy& segment, double u, State& out) const;
  void check_join(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after);

  ipc::Sampler* sampler_;
  State now_;
  State left_;
  State right_;
  ipc::BoardSnapshot snapshot_;
  std::vector<Seen> seen_;
  std::size_t ticks_ = 0;  ///< ticks since the last status without values or `revised`
  WatchReport report_;
};

}  // namespace splinecast::apps
