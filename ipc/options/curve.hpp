#pragma once

#include <optional>
#include <string>

#include "core/online/sliding_window.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"

/// The options of a curve, which its solver sets: functions that check them, write them to a
/// header, read them from one, and compare them.
namespace splinecast::ipc {

/// Throws BadRequest, with the value, for invalid options.
void require_options(const SolverOptions& options);

/// Writes the options of a new board into the stream's header: unset ones take their defaults.
/// Throws BadRequest as limits_for does.
void write_options(const SolverOptions& options, RegionHeader& header);

/// The curve's options in a header, as its solver set them.
[[nodiscard]] core::WindowOptions window_options(const RegionHeader& header);

/// The limits that the options give for the stream of this header. Throws BadRequest if they do not
/// fit its dimensions.
[[nodiscard]] MotionLimits limits_for(const SolverOptions& options, const RegionHeader& header);

/// The options of a live stream in a header; empty for a recorded one.
[[nodiscard]] std::optional<LiveOptions> live_options(const RegionHeader& header) noexcept;

/// Writes the law that a stream follows, from its header, into the header of the stream.
void put_law(const RegionHeader& law, RegionHeader& header) noexcept;

/// Throws BadRequest, naming what differs, if a solver's options contradict the header of the board
/// that it takes over.
void require_same_options(const std::string& stream, const RegionHeader& existing,
                          const SolverOptions& options);

}  // namespace splinecast::ipc
