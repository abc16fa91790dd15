#pragma once

#include <cstdint>

#include "apps/replay/player.hpp"

namespace splinecast::apps {

/// Throws TimeOut, or BadRegion if no solver can use the file under the board's name.
[[noreturn]] void throw_no_solver(const ReplayOptions& options);

/// Waits for a solver of a finished stream: the stream is recreated only then, so that its curve
/// can be read until then. Returns false if a stop is requested. Throws as throw_no_solver does.
[[nodiscard]] bool await_solver_of_finished(const ReplayOptions& options);

/// The time that the old motion of a recreated stream with this id still lasts: no solver attaches
/// to the stream before its end. Unless `quiet`, reports it on standard error.
[[nodiscard]] Time rest_of_old_motion(const ReplayOptions& options, std::uint64_t stream_id);

}  // namespace splinecast::apps
