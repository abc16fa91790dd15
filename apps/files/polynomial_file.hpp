#pragma once

#include <string>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::apps {

/// A trajectory of polynomial pieces.
struct PolynomialFile {
  std::vector<std::string> names;  ///< of its dimensions
  PiecewisePolynomial curve{1};
};

/// Reads a file of polynomials as quadrotor planners write them: CSV with a header
/// `duration,x^0,x^1,…,y^0,…`, one piece per row, lowest power first, in seconds from its start;
/// the first piece starts at time 0. Skips blank lines and lines that begin with `#`. Throws
/// InputError with file, line and column.
[[nodiscard]] PolynomialFile read_polynomials(const std::string& path);

}  // namespace splinecast::apps
