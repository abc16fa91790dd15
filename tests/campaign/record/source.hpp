#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/time.hpp"
#include "tests/campaign/record/plan.hpp"

namespace splinecast::campaign::record {

/// A stream as its sender knows it.
struct Sent {
  std::string stream{};
  std::uint64_t id = 0;
  std::uint64_t items = 0;
  std::optional<std::uint64_t> segments{};  ///< of a finished stream of recorded times
  bool is_left = false;                     ///< it still exists when its sender has ended
};
[[nodiscard]] nlohmann::json to_json(const std::vector<Sent>& sent);
[[nodiscard]] std::vector<Sent> sent_from(const nlohmann::json& json);

/// The position of each waypoint that a source sends; those of a replacement have the other motion.
[[nodiscard]] double position_at(Time time, std::size_t dimension, bool is_replacement) noexcept;

/// Creates the stream of a plan again and again, and sends to it. One of the returned streams has
/// the id of each. Runs in a process of its own.
[[nodiscard]] std::vector<Sent> run_source(const SourcePlan& plan);

/// Runs a law: its solver, and a commander that requests random rates.
[[nodiscard]] std::vector<Sent> run_law(const std::string& law, std::uint64_t seed, Time length);

}  // namespace splinecast::campaign::record
