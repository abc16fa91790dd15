#include "tests/campaign/streams/curve_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/polynomial/segment.hpp"

namespace splinecast::campaign {
namespace {

/// Normalising quaternions shorter than this amplifies rounding too much.
constexpr double kShortest = 1e-3;

double length_of(const ipc::SegmentCopy& segment) {
  return to_seconds(segment.right - segment.left);
}

/// For the derivatives 0 to 2 of a segment in one dimension, the sum of the absolute values of the
/// polynomial's terms.
std::array<double, 3> scales(const ipc::SegmentCopy& segment, std::size_t dimensions,
                             std::size_t d) {
  const double h = length_of(segment);
  std::array<double, 3> all{};
  double power = 1;
  for (std::size_t k = 0; k < static_cast<std::size_t>(segment.order); ++k, power *= h) {
    const double c = std::abs(segment.coefficients[k * dimensions + d]);
    const auto n = static_cast<double>(k);
    all[0] += c * power;
    if (k >= 1 && h > 0) all[1] += n * c * power / h;
    if (k >= 2 && h > 0) all[2] += n * (n - 1) * c * power / (h * h);
  }
  if (h == 0 && segment.order > 1) all[1] = std::abs(segment.coefficients[dimensions + d]);
  return all;
}

void evaluate_end(const ipc::SegmentCopy& segment, State& out) {
  core::evaluate(segment.order, segment.coefficients, length_of(segment), out.ref());
}

double norm(std::span<const double> values) {
  double sum = 0;
  for (const double x : values) sum += x * x;
  return std::sqrt(sum);
}

/// A difference divided by the tolerance for rounding.
double excess(double difference, double scale) {
  const double allowed = CurveRules::kRounding * scale + 1e-290;
  const double size = std::abs(difference);
  return std::isfinite(size) ? size / allowed : 2;
}

}  // namespace

CurveRules::Step CurveRules::step(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after) {
  const std::size_t dimensions = left_.dimensions();
  evaluate_end(before, left_);
  core::evaluate(after.order, after.coefficients, 0, right_.ref());
  std::array<double, kMaxDimensions> position{};
  std::array<double, kMaxDimensions> velocity{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    const auto b = scales(before, dimensions, d);
    const auto a = scales(after, dimensions, d);
    position[d] = std::max(b[0], a[0]);
    velocity[d] = std::max(b[1], a[1]);
  }
  for (const QuaternionDimensions& quaternion : kinds_->quaternions()) {
    const auto at = [&](std::span<const double> values) {
      return values.subspan(quaternion.first, kQuaternionSize);
    };
    const double shortest = std::min(norm(at(left_.position())), norm(at(right_.position())));
    const auto all_p = std::span(position).subspan(quaternion.first, kQuaternionSize);
    const auto all_v = std::span(velocity).subspan(quaternion.first, kQuaternionSize);
    const double p = std::ranges::max(all_p) / shortest;
    const double v = std::ranges::max(all_v) / shortest;
    const bool is_far_off = !(shortest > kShortest);
    std::ranges::fill(all_p, is_far_off ? HUGE_VAL : p);
    std::ranges::fill(all_v, is_far_off ? HUGE_VAL : v * (1 + p));
  }
  for (State* state : {&left_, &right_}) {
    const StateRef ref = state->ref();
    kinds_->normalise_quaternions(ref.position, ref.velocity, ref.acceleration);
  }
  Step most;
  for (std::size_t d = 0; d < dimensions; ++d) {
    most.position =
        std::max(most.position, excess(left_.position()[d] - right_.position()[d], position[d]));
    most.velocity =
        std::max(most.velocity, excess(left_.velocity()[d] - right_.velocity()[d], velocity[d]));
  }
  return most;
}

bool CurveRules::ends_at_rest(const ipc::SegmentCopy& segment, bool halts) {
  evaluate_end(segment, left_);
  for (std::size_t d = 0; d < left_.dimensions(); ++d) {
    const auto scale = scales(segment, left_.dimensions(), d);
    if (excess(left_.velocity()[d], scale[1]) > 1) return false;
    if (halts && excess(left_.acceleration()[d], scale[2]) > 1) return false;
  }
  return true;
}

bool CurveRules::passes(const ipc::SegmentCopy& segment, bool at_end,
                        std::span<const double> position, std::span<const Dimension> of) {
  const std::size_t dimensions = left_.dimensions();
  core::evaluate(segment.order, segment.coefficients, at_end ? length_of(segment) : 0, left_.ref());
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double x = left_.position()[d];
    const double scale = std::max(scales(segment, dimensions, d)[0], std::abs(position[d]));
    if (of[d].kind >= DimensionKind::quaternion) {
      const auto sent = position.subspan(d, kQuaternionSize);
      const auto read = left_.position().subspan(d, kQuaternionSize);
      const double n = norm(sent);
      double same = 0;
      double opposite = 0;
      for (std::size_t k = 0; k < kQuaternionSize; ++k) {
        same = std::max(same, std::abs(read[k] - sent[k] / n));
        opposite = std::max(opposite, std::abs(read[k] + sent[k] / n));
      }
      if (!(std::min(same, opposite) <= kRounding * std::max(scale, 1.0))) return false;
      d += kQuaternionSize - 1;
      continue;
    }
    const double period = of[d].period;
    const double off = period > 0 ? std::remainder(x - position[d], period) : x - position[d];
    if (excess(off, scale + period) > 1) return false;
  }
  return true;
}

}  // namespace splinecast::campaign
