#include "ipc/verification/difference.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/polynomial/segment.hpp"

namespace splinecast::ipc {
namespace {

std::optional<Difference> differ(std::string what, std::string published, std::string solved) {
  return Difference{
      .what = std::move(what), .published = std::move(published), .solved = std::move(solved)};
}

/// Whether the published right end is that of the solved segment, or an allowed cut before it.
bool may_end(const SegmentCopy& published, const core::Segment& solved, bool may_be_cut) noexcept {
  if (published.right == solved.right) return true;
  return may_be_cut && published.right > solved.left && published.right < solved.right;
}

/// Compares coefficients [power][dimension]. The sign of a zero does not count: a knot that a
/// later run writes again loses it.
std::optional<Difference> compare_coefficients(std::span<const double> published,
                                               std::span<const double> solved,
                                               std::size_t dimensions) {
  for (std::size_t k = 0; k < published.size(); ++k) {
    if (same_bits(published[k], solved[k]) || (published[k] == 0 && solved[k] == 0)) continue;
    const bool has_powers = published.size() > dimensions;
    std::string which = "coefficient";
    if (has_powers) which.append(" ").append(std::to_string(k / dimensions));
    which.append(" of dimension ").append(std::to_string(k % dimensions));
    return differ(std::move(which), in_words(published[k]), in_words(solved[k]));
  }
  return std::nullopt;
}

}  // namespace

bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(std::span<const double> a, std::span<const double> b) noexcept {
  return std::ranges::equal(a, b, [](double x, double y) { return same_bits(x, y); });
}

std::string in_words(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string in_words(Time time) { return std::to_string(time.count()) + " ns"; }

std::string in_words(SegmentKind kind) {
  constexpr std::array<const char*, 5> kNames{"spline", "entry", "stop", "hold", "slowed"};
  const auto i = static_cast<std::size_t>(kind);
  return i < kNames.size() ? kNames[i] : "unknown";
}

std::string first_in_words(std::span<const double> values) {
  return std::string("[").append(in_words(values[0])).append(", …]");
}

std::optional<Difference> compare(const SegmentCopy& published, const core::Segment& solved,
                                  std::size_t dimensions, bool may_be_cut) {
  if (published.left != solved.left) {
    return differ("left end", in_words(published.left), in_words(solved.left));
  }
  if (!may_end(published, solved, may_be_cut)) {
    return differ("right end", in_words(published.right), in_words(solved.right));
  }
  if (published.kind != solved.kind) {
    return differ("kind", in_words(published.kind), in_words(solved.kind));
  }
  if (published.order != solved.order) {
    return differ("order", std::to_string(published.order), std::to_string(solved.order));
  }
  const std::size_t count = static_cast<std::size_t>(solved.order) * dimensions;
  return compare_coefficients(std::span(published.coefficients).first(count), solved.coefficients,
                              dimensions);
}

namespace {

/// The size of the values from which the acceleration of a dimension follows by differences: its
/// rounding is proportional to it.
double size_of_acceleration(const SegmentCopy& segment, std::size_t d) noexcept {
  const std::size_t dimensions =
      segment.coefficients.size() / static_cast<std::size_t>(segment.order);
  const double seconds = to_seconds(segment.right - segment.left);
  double size = 0;
  double power = 1 / (seconds * seconds);
  for (int k = 0; k < segment.order; ++k, power *= seconds) {
    size += (k + 1) * std::abs(segment.coefficients[static_cast<std::size_t>(k) * dimensions + d]) *
            power;
  }
  return size;
}

}  // namespace

std::optional<Difference> compare_step(const SegmentCopy& before, const SegmentCopy& segment) {
  constexpr double kRounding = 1e-11;
  if (segment.number != before.next) return std::nullopt;
  const std::size_t dimensions =
      segment.coefficients.size() / static_cast<std::size_t>(segment.order);
  if (segment.acceleration_step.size() != dimensions) {
    return differ("acceleration step", "none", "one");
  }
  std::vector<double> end(dimensions);
  std::vector<double> start(dimensions);
  core::evaluate_derivative(before.order, before.coefficients,
                            to_seconds(before.right - before.left), 2, end);
  core::evaluate_derivative(segment.order, segment.coefficients, 0, 2, start);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double step = segment.acceleration_step[d];
    const double solved = start[d] - end[d];
    const double size = size_of_acceleration(before, d) + size_of_acceleration(segment, d);
    if (std::abs(step - solved) <= kRounding * size) continue;
    return differ("acceleration step", in_words(step), in_words(solved));
  }
  return std::nullopt;
}

}  // namespace splinecast::ipc
