#pragma once

#include <cstddef>
#include <vector>

namespace splinecast::campaign {

/// A motion that a producer sends, and that a reader sees if there is no fault.
class Motion {
 public:
  virtual ~Motion() = default;

  [[nodiscard]] virtual std::size_t joints() const noexcept = 0;
  /// Duration in s; the motion begins at 0.
  [[nodiscard]] virtual double seconds() const noexcept = 0;
  /// A joint's position in rad, or a derivative of it, at a time in s.
  [[nodiscard]] virtual double at(std::size_t joint, double t, int derivative = 0) const = 0;
  /// Largest absolute value of a derivative of a joint.
  [[nodiscard]] virtual double peak(std::size_t joint, int derivative) const = 0;

  [[nodiscard]] std::vector<double> positions(double t) const {
    std::vector<double> values(joints());
    for (std::size_t joint = 0; joint < values.size(); ++joint) values[joint] = at(joint, t);
    return values;
  }

 protected:
  Motion() = default;
  Motion(const Motion&) = default;
  Motion& operator=(const Motion&) = default;
};

}  // namespace splinecast::campaign
