#include <array>
#include <string>
#include <utility>

#include "ipc/arguments/handles.hpp"
#include "ipc/arguments/options.hpp"
#include "ipc/arguments/segments.hpp"
#include "ipc/arguments/states.hpp"
#include "ipc/arguments/waypoints.hpp"
#include "splinecast/fit.hpp"
#include "splinecast/piecewise_polynomial.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

struct splinecast_curve {
  Mark<0x5350'4c43'5552'5605> mark;
  PiecewisePolynomial curve;

  explicit splinecast_curve(PiecewisePolynomial fitted) : curve(std::move(fitted)) {}
};

namespace {

/// Runs the body of a function with the curve of a handle.
template <typename Body>
int with(const splinecast_curve* curve, const Body& body) noexcept {
  return guarded([&] { return body(require_handle(curve, "curve").curve); });
}

Time require_time(int64_t t, const PiecewisePolynomial& curve) {
  const int64_t first = curve.breaks().front().count();
  const int64_t last = curve.breaks().back().count();
  if (t < first || t > last) {
    refuse("t", "is " + std::to_string(t) + ", not " + std::to_string(first) + " to " +
                    std::to_string(last));
  }
  return Time(t);
}

}  // namespace

extern "C" {

int splinecast_fit(const splinecast_waypoints* waypoints, const splinecast_fit_options* options,
                   splinecast_curve** out) {
  return create_handle(out, [&] {
    const Recording recording(waypoints);
    const Waypoints& given = recording.waypoints();
    return new splinecast_curve(fit(given, fit_options(options, given.dimensions)));
  });
}

int splinecast_cross_validated_lambda(const splinecast_waypoints* waypoints, double* lambda) {
  return guarded([&] {
    require_pointer(lambda, "lambda");
    *lambda = cross_validated_lambda(Recording(waypoints).waypoints());
    return 0;
  });
}

int splinecast_curve_destroy(splinecast_curve* curve) { return destroy_handle(curve, "curve"); }

int splinecast_curve_dimensions(const splinecast_curve* curve) {
  return with(curve,
              [](const PiecewisePolynomial& own) { return static_cast<int>(own.dimensions()); });
}

int splinecast_curve_segments(const splinecast_curve* curve, size_t* segments) {
  return with(curve, [&](const PiecewisePolynomial& own) {
    *require_pointer(segments, "segments") = own.segments();
    return 0;
  });
}

int splinecast_curve_segment(const splinecast_curve* curve, size_t i, splinecast_segment* out) {
  return with(curve, [&](const PiecewisePolynomial& own) {
    require_size(out, sizeof(splinecast_segment), "out");
    require_segment(i, own.segments());
    put_segment({.left = own.left_of(i),
                 .right = own.right_of(i),
                 .order = own.order_of(i),
                 .kind = own.is_hold() ? SegmentKind::hold : SegmentKind::spline,
                 .coefficients = own.coefficients(i),
                 .waypoint = {},
                 .acceleration_step = {},
                 .is_corner = false},
                own.dimensions(), out);
    return 0;
  });
}

int splinecast_curve_evaluate(const splinecast_curve* curve, int64_t t,
                              const splinecast_state* out) {
  return with(curve, [&](const PiecewisePolynomial& own) {
    const Time at = require_time(t, own);
    const StateTarget target(out, own.dimensions());
    own.evaluate(at, target.ref());
    target.put();
    return 0;
  });
}

int splinecast_curve_derivative(const splinecast_curve* curve, int64_t t, int r,
                                const splinecast_output* out) {
  return with(curve, [&](const PiecewisePolynomial& own) {
    const Time at = require_time(t, own);
    const int order = require_choice(r, kMaxPolynomialOrder, "r");
    const Outputs values = require_output(*require_pointer(out, "out"), own.dimensions(), "out");
    std::array<double, kMaxDimensions> found{};
    own.derivative(at, order, std::span(found).first(own.dimensions()));
    for (std::size_t d = 0; d < values.size(); ++d) values[d] = found[d];
    return 0;
  });
}

}  // extern "C"
