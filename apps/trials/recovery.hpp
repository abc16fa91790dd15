#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Recovery times of a process after kills. One thread uses it.
class Recovery {
 public:
  /// The process was killed at this instant. Replaces an earlier kill that is still awaited.
  void begin(Time now) { since_ = now; }

  /// The process has recovered at this instant. Requires is_awaited().
  void end(Time now);

  /// Ignores the last kill.
  void forget() { since_.reset(); }

  [[nodiscard]] bool is_awaited() const { return since_.has_value(); }

  /// The time of the awaited kill, if there is one.
  [[nodiscard]] std::optional<Time> since() const { return since_; }

  /// Adds the measurements of another one.
  void add(const Recovery& other);

  /// `kills`, those with a recovery, and the recovery times: `p50_ms`, `p99_ms`, `max_ms`.
  [[nodiscard]] nlohmann::json result() const;

 private:
  std::optional<Time> since_;
  std::vector<double> took_ms_;
};

}  // namespace splinecast::apps
