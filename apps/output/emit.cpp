#include "apps/output/emit.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "apps/files/unit_of_name.hpp"
#include "apps/output/samples.hpp"
#include "splinecast/b_spline.hpp"
#include "splinecast/bezier.hpp"
#include "splinecast/calculus.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

ordered_json breaks_json(const PiecewisePolynomial& curve) {
  ordered_json breaks = ordered_json::array();
  for (const Time t : curve.breaks()) breaks.push_back(t.count());
  return breaks;
}

/// Points [i][dimension].
ordered_json points_json(std::span<const double> values, std::size_t dimensions) {
  ordered_json points = ordered_json::array();
  for (std::size_t i = 0; i < values.size(); i += dimensions) {
    points.push_back(values.subspan(i, dimensions));
  }
  return points;
}

/// Coefficients [dimension][power, highest first] of a segment.
ordered_json coefficients_json(std::span<const double> coefficients, std::size_t dimensions) {
  ordered_json segment = ordered_json::array();
  for (std::size_t d = 0; d < dimensions; ++d) {
    ordered_json powers = ordered_json::array();
    for (std::size_t k = coefficients.size() / dimensions; k-- > 0;) {
      powers.push_back(coefficients[k * dimensions + d]);
    }
    segment.push_back(std::move(powers));
  }
  return segment;
}

ordered_json pp_json(const PiecewisePolynomial& curve) {
  ordered_json segments = ordered_json::array();
  for (std::size_t i = 0; i < curve.segments() && !curve.is_hold(); ++i) {
    segments.push_back(coefficients_json(curve.coefficients(i), curve.dimensions()));
  }
  return {{"breaks_ns", breaks_json(curve)}, {"coefficients", std::move(segments)}};
}

ordered_json bezier_json(const PiecewisePolynomial& curve) {
  ordered_json segments = ordered_json::array();
  if (!curve.is_hold()) {
    for (const BezierSegment& segment : to_bezier(curve)) {
      segments.push_back(points_json(segment.control_points, curve.dimensions()));
    }
  }
  return {{"breaks_ns", breaks_json(curve)}, {"segments", std::move(segments)}};
}

ordered_json b_spline_json(const PiecewisePolynomial& curve) {
  BSpline spline{.degree = curve.order() - 1,
                 .dimensions = curve.dimensions(),
                 .origin = curve.breaks().front(),
                 .knots = {},
                 .control_points = {}};
  if (!curve.is_hold()) spline = to_b_spline(curve);
  ordered_json knots = ordered_json::array();
  for (const Time knot : spline.knots) knots.push_back(to_seconds(knot));
  return {{"degree", spline.degree},
          {"origin_ns", spline.origin.count()},
          {"knots", std::move(knots)},
          {"control_points", points_json(spline.control_points, spline.dimensions)}};
}

}  // namespace

std::optional<Emit> parse_emit(std::string_view text) noexcept {
  if (text == "samples") return Emit::samples;
  if (text == "pp") return Emit::pp;
  if (text == "bezier") return Emit::bezier;
  if (text == "bspline") return Emit::bspline;
  return std::nullopt;
}

void emit_samples(std::span<const PiecewisePolynomial> parts, const DimensionKinds& kinds,
                  const std::vector<Time>& at, std::optional<Time> dt, Output& output) {
  SampleWriter writer(output, parts.front().dimensions(), kinds);
  State state(parts.front().dimensions());
  const auto write = [&](const PiecewisePolynomial& part, Time t) {
    part.evaluate(t, state.ref());
    kinds.normalise(state.ref());
    writer.write(t, state);
  };
  for (const Time t : at) {
    const auto has = [t](const auto& part) { return covers(part, t); };
    write(*std::ranges::find_if(parts, has), t);
  }
  if (!dt) return;
  for (const PiecewisePolynomial& part : parts) {
    const Time last = part.breaks().back();
    Time t = part.breaks().front();
    for (write(part, t); last - t >= *dt; write(part, t)) t += *dt;
  }
}

void emit_json(const PiecewisePolynomial& curve, const std::vector<std::string>& columns, Emit what,
               Output& output) {
  const auto even = raised(curve, curve.order());
  const auto json = [&] {
    switch (what) {
      case Emit::bezier:
        return bezier_json(even);
      case Emit::bspline:
        return b_spline_json(even);
      default:
        return pp_json(even);
    }
  };
  ordered_json all = json();
  all["names"] = ordered_json::array();
  all["units"] = ordered_json::array();
  for (const std::string& column : columns) {
    auto [name, unit] = name_and_unit(column);
    all["names"].push_back(std::move(name));
    all["units"].push_back(std::move(unit));
  }
  output.write(all.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
  output.write("\n");
}

}  // namespace splinecast::apps
