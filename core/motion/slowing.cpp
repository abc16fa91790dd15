#include "core/motion/slowing.hpp"

namespace splinecast::core {

Time Slowing::time_of(Time s) const noexcept {
  // The motion comes so slowly to its end that rounding would make this time earlier.
  if (s - begin_ >= length_ / 2) return end_time();
  const auto length = static_cast<double>(length_.count());
  const auto way = static_cast<double>((s - begin_).count());
  const auto has_reached = [&](Time t) {
    const double u = static_cast<double>(t.count()) / length;
    return length * (u - u * u * u * (1 - u / 2)) >= way;
  };
  Time low{};  // the motion has not been there before
  Time high = length_;
  while (low < high) {
    const Time middle = low + (high - low) / 2;
    if (has_reached(middle)) {
      high = middle;
    } else {
      low = middle + Time(1);
    }
  }
  return begin_ + low;
}

double Slowing::way_at(Time t) const noexcept {
  const double u = to_seconds(t - begin_) / to_seconds(length_);
  return to_seconds(length_) * (u - u * u * u * (1 - u / 2));
}

void Slowing::write_state(Time t, std::span<const double> velocity, std::span<const double> before,
                          std::span<const double> after, std::span<double> slowed_velocity,
                          std::span<double> slowed_acceleration) const noexcept {
  const double u = to_seconds(t - begin_) / to_seconds(length_);
  // At the end, exactly 0: the motion rests.
  const bool rests = t == end_time();
  const double rate = rests ? 0 : 1 - u * u * (3 - 2 * u);
  const double slope = rests ? 0 : -6 * u * (1 - u) / to_seconds(length_);
  for (std::size_t d = 0; d < velocity.size(); ++d) {
    const double bend = before[d] + (after[d] - before[d]) / 2;
    // Adding 0 makes a negative 0 positive.
    slowed_acceleration[d] = bend * rate * rate + velocity[d] * slope + 0.0;
    slowed_velocity[d] = velocity[d] * rate + 0.0;
  }
}

}  // namespace splinecast::core
