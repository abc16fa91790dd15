#include "core/motion/end.hpp"

#include <algorithm>

#include "core/forms/stop.hpp"

namespace splinecast::core {

Time AfterEntry::stop_length() const noexcept {
  return std::max(rest - stop_begin(), kLeastStopTime);
}

void AfterEntry::write_line_end(std::span<const double> position, std::span<const double> velocity,
                                std::span<double> out) const noexcept {
  const double line = to_seconds(line_end - end);
  for (std::size_t d = 0; d < out.size(); ++d) out[d] = position[d] + line * velocity[d];
}

}  // namespace splinecast::core
