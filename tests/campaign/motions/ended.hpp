#pragma once

#include <span>
#include <string_view>

#include "splinecast/limits.hpp"
#include "tests/campaign/motions/motion.hpp"
#include "tests/campaign/motions/schedule.hpp"
#include "tests/campaign/motions/sines.hpp"

namespace splinecast::campaign {

/// The first seconds of a motion; then it rests.
class EndedMotion final : public Motion {
 public:
  static constexpr double kEnd = 6;       ///< s, the time of its last waypoint
  static constexpr double kSeconds = 10;  ///< s

  /// `eases`: it comes to rest within the last second. `motion` outlives this.
  EndedMotion(const Sines& motion, bool eases) : motion_(motion), eases_(eases) {}

  [[nodiscard]] std::size_t joints() const noexcept override { return motion_.joints(); }
  [[nodiscard]] double seconds() const noexcept override { return kSeconds; }
  [[nodiscard]] double at(std::size_t joint, double t, int derivative = 0) const override;
  [[nodiscard]] double peak(std::size_t joint, int derivative) const override {
    return motion_.peak(joint, derivative);
  }

 private:
  const Sines& motion_;
  bool eases_;
};

/// A stream that ends while it moves, or at rest.
struct Ended {
  std::string_view name;
  std::string_view file;  ///< name of its plots
  bool eases = false;     ///< the motion comes to rest at its last waypoint
  double rate = 100;      ///< Hz
  double lead = 0.4;      ///< s
  double finish = 0;      ///< s after the last waypoint has been sent
  double wall = 0;        ///< rad: a bound this far before the last waypoint; 0: no bounds

  /// The calls of the producer, and `finish`.
  [[nodiscard]] Schedule schedule(const EndedMotion& motion) const;
  /// The limits of the stream, for a limit of acceleration in rad/s²; 0: none.
  [[nodiscard]] MotionLimits limits(const EndedMotion& motion, double acceleration) const;
};

[[nodiscard]] std::span<const Ended> ends();

}  // namespace splinecast::campaign
