#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/output/stream.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::apps {

/// Output formats of `fit`.
enum class Emit {
  samples,  ///< CSV
  pp,       ///< piecewise polynomial, JSON
  bezier,   ///< Bezier control points, JSON
  bspline,  ///< B-spline, JSON
};

/// Reads `samples`, `pp`, `bezier` or `bspline`. Returns nothing for any other text.
[[nodiscard]] std::optional<Emit> parse_emit(std::string_view text) noexcept;

/// Whether a time is between the first and the last break of a curve.
[[nodiscard]] inline bool covers(const PiecewisePolynomial& curve, Time t) noexcept {
  return t >= curve.breaks().front() && t <= curve.breaks().back();
}

/// Writes samples at the times `at`, each of which is in one of the parts of a curve, then, if `dt`
/// is set, every `dt` from the first to the last break of each part. Normalises them for these
/// kinds, as a reader does. At least one part.
void emit_samples(std::span<const PiecewisePolynomial> parts, const DimensionKinds& kinds,
                  const std::vector<Time>& at, std::optional<Time> dt, Output& output);

/// Writes a line of JSON, with all segments raised to the highest order. The curve of a single
/// waypoint has no segment: the output has the waypoint's time and empty lists.
///
/// - `pp`: `breaks_ns`, `coefficients[segment][dimension][power, highest first]` in seconds.
/// - `bezier`: `breaks_ns`, `segments[segment][0…order−1][dimension]`.
/// - `bspline`: `degree`, `origin_ns`, `knots` in seconds from the origin,
///   `control_points[i][dimension]`.
///
/// Each has `names` and `units`, which the titles of the columns give; a unit may be empty.
void emit_json(const PiecewisePolynomial& curve, const std::vector<std::string>& columns, Emit what,
               Output& output);

}  // namespace splinecast::apps
