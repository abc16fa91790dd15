#pragma once

#include <atomic>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "splinecast/time.hpp"

/// A stream that another process writes.
namespace splinecast::bench {

inline constexpr std::size_t kWrittenDimensions = 7;
inline constexpr std::size_t kWrittenKnots = 4096;

/// For a child process: publishes kWrittenKnots waypoints of a recorded stream, each in its own
/// revision, on a board that holds `capacity` knots, and sets `ready` to 1. Then publishes one more
/// per `interval`, as fast as possible if that is 0, or none if it is unset, until a stop is
/// requested. Runs on the far core.
nlohmann::json write_stream(const std::string& stream, std::size_t capacity,
                            std::optional<Time> interval, std::atomic<std::uint64_t>& ready);

}  // namespace splinecast::bench
