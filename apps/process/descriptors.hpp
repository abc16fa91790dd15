#pragma once

#include <cstddef>

namespace splinecast::apps {

/// File descriptors that this process may have open: RLIMIT_NOFILE.
[[nodiscard]] std::size_t descriptor_limit() noexcept;

/// Raises that to what an unprivileged process may raise it to. A program that holds many streams
/// does so before it opens the first one.
void raise_descriptor_limit() noexcept;

}  // namespace splinecast::apps
