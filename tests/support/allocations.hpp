#pragma once

#include <cstddef>

namespace splinecast::testing {

/// How often this thread has allocated so far.
std::size_t allocations() noexcept;

}  // namespace splinecast::testing
