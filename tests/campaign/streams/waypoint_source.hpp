#pragma once

#include <vector>

#include "splinecast/waypoint.hpp"
#include "tests/campaign/streams/plan.hpp"

namespace splinecast::campaign {

/// The values of a simulated producer's waypoints: a smooth, quantised, constant or noisy motion.
class WaypointSource {
 public:
  WaypointSource(const StreamPlan& plan, Random& random);

  /// Chooses the mode of the next waypoints at random.
  void change_mode();

  /// The waypoint at t, mostly with derivatives if the method needs them. The view is valid until
  /// the next call.
  [[nodiscard]] Waypoint at(Time t);

  /// The state of the smooth motion at t, with all derivatives. The view is valid until the next
  /// call.
  [[nodiscard]] Waypoint smooth_at(Time t);

 private:
  enum class Mode { smooth, quantised, repeated, noisy };
  struct Wave {
    double amplitude = 0;
    double frequency = 0;
    double phase = 0;
    double offset = 0;
  };
  struct Values {
    double x = 0, v = 0, a = 0;
  };
  [[nodiscard]] static Values wave_at(const Wave& wave, double s);
  void write_motion(Time t);
  void write_quaternion(std::size_t d, const Values& angle);
  void spoil();
  [[nodiscard]] Waypoint view(Time t, bool with_derivatives) const;

  const StreamPlan* plan_;
  Random* random_;
  Mode mode_ = Mode::smooth;
  double grid_ = 1;  ///< grid of quantised values, in amplitudes
  std::vector<Wave> waves_;
  std::vector<double> position_, velocity_, acceleration_;
};

}  // namespace splinecast::campaign
