#include "apps/demo/pick_and_place.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <string>

namespace splinecast::apps {
namespace {

constexpr std::size_t kJoints = 7;
using Pose = std::array<double, kJoints>;

// Above the pick, at the pick, above it again, above the place, at the place, above it again.
constexpr std::array<Pose, 6> kPoses{{
    {0.40, -0.30, 0.10, -2.00, 0.05, 1.75, 0.80},
    {0.40, 0.15, 0.10, -2.20, 0.05, 2.35, 0.80},
    {0.40, -0.30, 0.10, -2.00, 0.05, 1.75, 0.80},
    {-0.90, -0.20, -0.15, -1.90, -0.10, 1.70, -0.40},
    {-0.90, 0.25, -0.15, -2.05, -0.10, 2.30, -0.40},
    {-0.90, -0.20, -0.15, -1.90, -0.10, 1.70, -0.40},
}};

constexpr Time kCycle = std::chrono::milliseconds(10);
constexpr Time kMove = std::chrono::milliseconds(900);
constexpr Time kDwell = std::chrono::milliseconds(150);
constexpr std::int64_t kJitter = 2'000'000;  // ns

/// The position of a minimum-jerk move from 0 to 1 after the fraction s of its time.
double minimum_jerk(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

/// Numbers that are the same on every machine, which the standard's distributions are not.
class Random {
 public:
  /// Uniform between −amplitude and amplitude.
  std::int64_t next(std::int64_t amplitude) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    const auto upper = static_cast<std::int64_t>(state_ >> 33U);
    return upper % (2 * amplitude + 1) - amplitude;
  }

 private:
  std::uint64_t state_ = 7;
};

Pose pose_at(Time t) {
  const Time cycle = kMove + kDwell;
  const auto move = static_cast<std::size_t>(t / cycle);
  const Pose& from = kPoses[move % kPoses.size()];
  const Pose& to = kPoses[(move + 1) % kPoses.size()];
  const double fraction = std::min(1.0, to_seconds(t % cycle) / to_seconds(kMove));
  Pose pose{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    pose[j] = from[j] + (to[j] - from[j]) * minimum_jerk(fraction);
  }
  return pose;
}

}  // namespace

WaypointTable pick_and_place(Time duration) {
  WaypointTable table;
  table.file = "pick-and-place";
  for (std::size_t j = 0; j < kJoints; ++j) table.names.push_back("joint" + std::to_string(j + 1));
  Random random;
  std::size_t row = 1;
  for (Time due{}; due <= duration; due += kCycle) {
    const bool is_end = due == Time::zero() || due + kCycle > duration;
    const Time t = is_end ? due : due + Time(random.next(kJitter));
    const Pose pose = pose_at(t);
    table.times.push_back(t);
    table.lines.push_back(++row);
    table.positions.insert(table.positions.end(), pose.begin(), pose.end());
  }
  return table;
}

}  // namespace splinecast::apps
