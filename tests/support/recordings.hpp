#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/mesh.hpp"
#include "support/process.hpp"

namespace splinecast::testing {

/// A mesh as a waypoint file: `t_ns,x0,x1,…`.
std::string to_csv(const Mesh& mesh);

/// Times of a mesh and between its knots as an `--at` file.
std::string times_csv(const Mesh& mesh, std::size_t per_interval);

/// What `sample` writes, without its last column.
std::string without_status(const std::string& samples);

/// How many rows of `sample`'s output end in this status.
std::size_t count_status(const std::string& samples, const std::string& status);

/// Success if two texts are the same; else where they first differ. (gtest's own comparison takes
/// minutes over long texts.)
::testing::AssertionResult same_text(const std::string& got, const std::string& wanted);

}  // namespace splinecast::testing
