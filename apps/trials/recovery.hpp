#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// How long something takes to come back after a kill, and how often it did. One thread uses it.
class Recovery {
 public:
  /// It was killed at this instant. What was awaited before is not awaited any more.
  void begin(Time now) { since_ = now; }

  /// It is back, at this instant; it must have been awaited.
  void end(Time now);

  /// It does not matter any more.
  void forget() { since_.reset(); }

  [[nodiscard]] bool is_awaited() const { return since_.has_value(); }

  /// Since when it has been away, if it is.
  [[nodiscard]] std::optional<Time> since() const { return since_; }

  /// Counts what another one has measured as its own.
  void add(const Recovery& other);

  /// `kills`, those after which it came back, and how long that took: `p50_ms`, `p99_ms`,
  /// `max_ms`.
  [[nodiscard]] nlohmann::json result() const;

 private:
  std::optional<Time> since_;
  std::vector<double> took_ms_;
};

}  // namespace splinecast::apps
