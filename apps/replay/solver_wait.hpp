#pragma once

#include <cstdint>

#include "apps/replay/player.hpp"

namespace splinecast::apps {

/// Throws TimeOut, or BadRegion if no solver can use the file under the board's name.
[[noreturn]] void throw_no_solver(const ReplayOptions& options);

/// Waits for a solver of a finished stream. The caller recreates the stream only after this, so
/// that the old curve stays readable until a solver exists. Returns false if a stop is requested.
/// Throws as throw_no_solver does.
[[nodiscard]] bool await_solver_of_finished(const ReplayOptions& options);

/// Waits until the time law that the stream is to follow, if any, has begun. Returns false if a
/// stop is requested. Throws TimeOut after --wait; BadRegion if the stream of that name is not a
/// law.
[[nodiscard]] bool await_law(const ReplayOptions& options);

/// How long the old motion of a recreated stream with this id still lasts. No solver attaches to
/// the stream before this motion has ended. Unless `quiet`, reports the time on standard error.
[[nodiscard]] Time rest_of_old_motion(const ReplayOptions& options, std::uint64_t stream_id);

}  // namespace splinecast::apps
