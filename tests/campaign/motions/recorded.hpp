#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"
#include "tests/campaign/motions/motion.hpp"
#include "tests/campaign/motions/schedule.hpp"

namespace splinecast::campaign {

/// A recording: the natural `c2` batch spline through all of its waypoints.
class Recorded final : public Motion {
 public:
  /// Reads the columns of these names, in m or rad, from a waypoint file.
  [[nodiscard]] static Recorded from_waypoints(const std::filesystem::path& file,
                                               const std::vector<std::string>& columns);
  /// Samples a file of polynomials at 100 Hz.
  [[nodiscard]] static Recorded from_polynomials(const std::filesystem::path& file);

  [[nodiscard]] std::size_t joints() const noexcept override { return curve_.dimensions(); }
  [[nodiscard]] double seconds() const noexcept override;
  /// t outside the recording clamps to its nearest end.
  [[nodiscard]] double at(std::size_t joint, double t, int derivative = 0) const override;
  /// In closed form.
  [[nodiscard]] double peak(std::size_t joint, int derivative) const override;

  /// The waypoints of the recording, each sent `lead` s before its time, without those in the gaps.
  /// The producer is therefore silent from `lead` before each gap.
  [[nodiscard]] Schedule schedule(double lead, std::vector<std::pair<double, double>> gaps) const;

 private:
  Recorded(std::size_t dimensions, std::vector<Time> times, const std::vector<double>& positions);

  PiecewisePolynomial curve_;
};

}  // namespace splinecast::campaign
