#include "tests/campaign/kills/payload.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace splinecast::campaign {
namespace {

constexpr Payload::Row kFactors{1, -1, 2, 0.25};
constexpr double kAngularFrequency = 3;  // rad/s, of the smooth shape

/// A pseudorandom value from −1 to 1: Knuth's multiplicative hash.
double rough(ipc::Word number) noexcept {
  constexpr std::uint32_t kMultiplier = 2654435761U;
  const auto hash = static_cast<std::uint32_t>(number + 1) * kMultiplier;
  return static_cast<double>(hash) / 0x1p31 - 1;
}

}  // namespace

Payload::Payload(Time origin, Time interval, Shape shape)
    : origin_(origin), interval_(interval), shape_(shape) {}

Time Payload::time_of(ipc::Word number) const noexcept {
  return origin_ + interval_ * static_cast<std::int64_t>(number);
}

std::optional<ipc::Word> Payload::number_at(Time t) const noexcept {
  const ipc::Word number = number_from(t);
  return time_of(number) == t ? std::optional(number) : std::nullopt;
}

ipc::Word Payload::number_from(Time t) const noexcept {
  const Time since = std::max(t - origin_, Time::zero());
  return static_cast<ipc::Word>((since + interval_ - Time(1)) / interval_);
}

Payload::Row Payload::position_of(ipc::Word number) const noexcept {
  const double x = shape_ == Shape::rough
                       ? rough(number)
                       : std::cos(kAngularFrequency * to_seconds(time_of(number) - origin_));
  Row row = kFactors;
  for (double& value : row) value *= x;
  return row;
}

bool Payload::is_whole(std::span<const double> rows) noexcept {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t d = i % kDimensions;
    if (rows[i] != kFactors[d] * rows[i - d]) return false;  // no NaN is whole
  }
  return true;
}

}  // namespace splinecast::campaign
