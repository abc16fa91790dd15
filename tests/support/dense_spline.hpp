#pragma once

#include <Eigen/Dense>

#include "splinecast/core/condition.hpp"
#include "support/mesh.hpp"

namespace splinecast::testing {

/// The knot velocities of the C² spline, [knot][dimension], by a dense solve of its equations:
/// an oracle that shares no code with the library.
Eigen::MatrixXd dense_velocities(const Mesh& mesh, const core::Condition& start,
                                 const core::Condition& end);

/// The same with a tail instead of an end condition.
Eigen::MatrixXd dense_velocities(const Mesh& mesh, const core::Condition& start, core::Tail tail);

}  // namespace splinecast::testing
