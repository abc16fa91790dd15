#include "apps/demo/controller.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "apps/process/signals.hpp"
#include "apps/streams/attach.hpp"
#include "core/basics/quantile.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/sampling/snapshot.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

constexpr Time kPeriod = std::chrono::milliseconds(1);
constexpr Time kWait = std::chrono::seconds(15);
/// How long a reader continues after the last waypoint: long enough to see the curve hold.
constexpr Time kAfterEnd = std::chrono::milliseconds(100);

/// Largest differences in position, velocity and acceleration.
class LargestStep {
 public:
  void compare(const State& a, const State& b) {
    const std::size_t dimensions = a.dimensions();
    for (std::size_t i = 0; i < largest_.size() * dimensions; ++i) {
      double& most = largest_[i / dimensions];
      most = std::max(most, std::abs(a.values()[i] - b.values()[i]));
    }
  }
  [[nodiscard]] nlohmann::json json() const { return largest_; }

 private:
  std::array<double, 3> largest_{};
};

class DemoReader {
 public:
  explicit DemoReader(const std::string& stream)
      : reader_(attach_reader(stream, kWait)),
        kinds_(reader_.kinds()),
        snapshot_(reader_.dimensions()),
        now_(reader_.dimensions()),
        before_(reader_.dimensions()),
        left_(reader_.dimensions()),
        right_(reader_.dimensions()) {}

  nlohmann::json run() {
    Time due = clock_.now();
    while (!has_ended() && sleep_until(due)) {
      tick();
      due += kPeriod;
    }
    return {
        {"samples", samples_},
        {"by_status", by_status_},
        {"step_at_knots", at_knots_.json()},
        {"change_of_the_past", of_the_past_.json()},
        {"age_ms", {core::quantile(std::span(ages_), 0.5), core::quantile(std::span(ages_), 1.0)}},
        {"sample_ns",
         {core::quantile(std::span(costs_), 0.5), core::quantile(std::span(costs_), 0.99)}}};
  }

 private:
  void tick() {
    const Time t = clock_.now();
    const auto status = reader_.sample(t, now_);
    costs_.push_back(static_cast<double>((clock_.now() - t).count()));
    ++samples_;
    ++by_status_[static_cast<std::size_t>(status)];
    if (ipc::Internals::summary(reader_, summary_) && !summary_.finished) {
      ages_.push_back(to_seconds(t - summary_.committed) * 1e3);
    }
    if (has_values(status)) check(t);
  }

  /// Compares the segments on both sides of each knot since the last tick, and the curve at that
  /// tick with the sample that was read then.
  void check(Time t) {
    if (has_before_) {
      if (has_values(reader_.sample(before_time_, left_))) of_the_past_.compare(left_, before_);
      if (has_values(ipc::Internals::sampler(reader_).snapshot(before_time_, t, snapshot_)))
        check_knots();
    }
    std::swap(now_, before_);
    before_time_ = t;
    has_before_ = true;
  }

  void check_knots() {
    const auto segments = snapshot_.segments();
    for (std::size_t i = 1; i < segments.size(); ++i) {
      const ipc::SegmentCopy& a = segments[i - 1];
      const ipc::SegmentCopy& b = segments[i];
      evaluate(a, to_seconds(a.right - a.left), left_);
      evaluate(b, 0, right_);
      at_knots_.compare(left_, right_);
    }
  }

  /// Does not wrap periodic dimensions, which would step by a period.
  void evaluate(const ipc::SegmentCopy& segment, double u, State& out) const {
    const StateRef ref = out.ref();
    core::evaluate(segment.order, segment.coefficients, u, ref);
    kinds_.normalise_quaternions(ref.position, ref.velocity, ref.acceleration);
  }

  [[nodiscard]] bool has_ended() const {
    return summary_.finished && clock_.now() > summary_.newest_time + kAfterEnd;
  }

  MonotonicClock clock_;
  Reader reader_;
  DimensionKinds kinds_;
  ipc::Summary summary_;
  ipc::BoardSnapshot snapshot_;
  State now_, before_, left_, right_;
  Time before_time_{};
  bool has_before_ = false;
  std::size_t samples_ = 0;
  std::array<std::size_t, kSampleStatuses> by_status_{};
  LargestStep at_knots_;
  LargestStep of_the_past_;
  std::vector<double> ages_;
  std::vector<double> costs_;
};

}  // namespace

nlohmann::json run_demo_reader(const std::string& stream) { return DemoReader(stream).run(); }

}  // namespace splinecast::apps
