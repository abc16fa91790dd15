#pragma once

#include <cstdint>

#include "apps/replay/player.hpp"

namespace splinecast::apps {

/// Throws TimeOut, or BadRegion if no solver can use the file under the board's name.
[[noreturn]] void throw_no_solver(const ReplayOptions& options);

/// A finished stream is made again only once there is a solver for the new one: until then its
/// curve can still be read. Returns false if a stop is requested meanwhile. Throws as
/// throw_no_solver does.
[[nodiscard]] bool await_solver_of_finished(const ReplayOptions& options);

/// How long the old motion of a stream that was made again, with this id, still lasts: no solver
/// takes the stream up before its end. Unless `quiet`, says so on standard error.
[[nodiscard]] Time rest_of_old_motion(const ReplayOptions& options, std::uint64_t stream_id);

}  // namespace splinecast::apps
