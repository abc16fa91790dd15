#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "core/laws/rate_plan.hpp"
#include "ipc/law/commands.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The rate of a law as its commanders request it: the curve that is in force, and each commander's
/// bound. See core/laws/rate_plan.hpp for the rules. A change is planned first, and is in force
/// only when its caller has seen it committed. One thread uses it. Allocates for new commanders.
class CommandedRate {
 public:
  /// Of a law with this largest rate.
  explicit CommandedRate(double largest) : largest_(largest) {}

  /// Begins with the curve that is in force from `t` on, and with the requests that are there. A
  /// commander that requests more than the law has at `t` is bounded by its request alone; one that
  /// requests less, as if it made its request at `t`.
  void begin(const core::RateCurve& curve, const Commanders& commanders, Time t);

  /// Plans the rate from `t` on, which is of plan_begin(), after `commanders` has been read. A
  /// request counts as a new one if its rate or its ramp is another; a renewal does not. A
  /// commander without a region any more counts as released. Nothing if the curve needs no change
  /// now.
  [[nodiscard]] std::optional<core::RateCurve> plan(const Commanders& commanders, Time t);

  /// When a plan can begin that would begin at `t`: see core::plan_begin().
  [[nodiscard]] Time plan_begin(Time t) const noexcept {
    return core::plan_begin(in_force_.curve, t);
  }

  /// The last plan has been committed.
  void commit() { in_force_ = planned_; }

 private:
  struct Commander {
    std::string name;
    core::RateRequest request;
    bool is_there = true;
    core::RateCurve bound;
  };
  struct State {
    std::vector<Commander> commanders;
    core::RateCurve curve{1};
    Time ramp = kShortestRamp;  ///< of the newest request
  };

  void take_requests(const Commanders& commanders, Time t);

  double largest_;
  State in_force_;
  State planned_;
  std::vector<core::RateCurve> bounds_;  ///< scratch
};

}  // namespace splinecast::ipc
