#pragma once

#include <cstddef>
#include <cstdint>

#include "splinecast.h"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/fit.hpp"
#include "splinecast/options.hpp"

/// Options of a C program as the library takes them: checked as far as C needs it; the library
/// checks the rest. Throws BadArgument.
namespace splinecast::ipc {

[[nodiscard]] ProducerOptions producer_options(const splinecast_producer_options* given);
[[nodiscard]] SolverOptions solver_options(const splinecast_solver_options* given);
[[nodiscard]] FitOptions fit_options(const splinecast_fit_options* given, std::size_t dimensions);
[[nodiscard]] Condition condition(const splinecast_condition& given, std::size_t dimensions,
                                  const char* name);

/// Permission bits up to 0777, and −1 or the number of a group.
[[nodiscard]] RegionAccess access_of(std::uint32_t mode, std::int64_t group);

/// −1 or the number of a user: regions of that user are used too.
[[nodiscard]] Trust trust_of(std::int64_t owner, const char* name);

}  // namespace splinecast::ipc
