#pragma once

#include <cstddef>

namespace splinecast::apps {

/// Number of file descriptors that this process may have open: the soft limit of RLIMIT_NOFILE.
[[nodiscard]] std::size_t descriptor_limit() noexcept;

/// Raises this soft limit to the hard limit. Call it before the first of many streams is opened.
void raise_descriptor_limit() noexcept;

}  // namespace splinecast::apps
