#pragma once

#include "support/options.hpp"

namespace splinecast::apps {

/// Adds the verb `doctor`. It exits with 1 if it found a problem.
void add_doctor(CLI::App& program, Action& action);

}  // namespace splinecast::apps
