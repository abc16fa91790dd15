#pragma once

#include <optional>
#include <string>

#include "core/online/sliding_window.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"

/// The options of a curve, which its solver gives: checked, written to a header, read from one,
/// compared.
namespace splinecast::ipc {

/// Throws BadRequest, with the value, for options that can be no stream's.
void require_options(const SolverOptions& options);

/// Writes the options of a new board into the stream's header: what is unset takes its default.
/// Throws BadRequest as limits_for does.
void write_options(const SolverOptions& options, RegionHeader& header);

/// What a header says of the curve: the options that its solver gave.
[[nodiscard]] core::WindowOptions window_options(const RegionHeader& header);

/// Limits that the options ask for on the stream of this header. Throws BadRequest if they do not
/// go with its dimensions.
[[nodiscard]] MotionLimits limits_for(const SolverOptions& options, const RegionHeader& header);

/// What a header says of how a live stream is solved; nothing for a recorded one.
[[nodiscard]] std::optional<LiveOptions> live_options(const RegionHeader& header) noexcept;

/// Throws BadRequest, naming what differs, if a solver's options contradict the header of the board
/// that it is to take over.
void require_same_options(const std::string& stream, const RegionHeader& stands,
                          const SolverOptions& options);

}  // namespace splinecast::ipc
