#include "splinecast/fit.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "core/basics/number_text.hpp"
#include "ipc/python/curve.hpp"
#include "ipc/python/docstrings.hpp"
#include "ipc/python/held.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/options.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

/// Largest λ of a smoothing spline.
constexpr double kMostLambda = 1e100;

void require_increasing(std::span<const double> times) {
  const auto text = [&](std::size_t i) {
    return "times[" + std::to_string(i) + "] = " + core::number_text(times[i]) + " s";
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) throw BadRequest(text(i) + " is not finite");
    if (i > 0 && !(times[i] > times[i - 1])) {
      throw BadRequest(text(i) + " is not after " + text(i - 1));
    }
  }
}

/// The waypoints of a fit, in the time of the polynomial.
class Mesh {
 public:
  Mesh(py::handle times, py::handle positions, py::handle velocities, py::handle accelerations)
      : instants_(times),
        positions_(positions, "positions"),
        velocities_(velocities, "velocities"),
        accelerations_(accelerations, "accelerations") {
    instants_.require_line();
    const std::size_t dimensions = positions_.dimensions();
    positions_.require(instants_.size(), dimensions, false);
    velocities_.require(instants_.size(), dimensions, true);
    accelerations_.require(instants_.size(), dimensions, true);
    if (instants_.is_seconds() && instants_.size() > 0) scale_seconds();
    waypoints_ = {.dimensions = dimensions,
                  .times = instants_.is_seconds() ? ticks_ : instants_.times(ticks_),
                  .positions = positions_.all(),
                  .velocities = in_ticks(velocities_, 1, scaled_velocities_),
                  .accelerations = in_ticks(accelerations_, 2, scaled_accelerations_)};
  }
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  [[nodiscard]] const Waypoints& waypoints() const { return waypoints_; }
  [[nodiscard]] const TimeScale& scale() const { return scale_; }
  [[nodiscard]] bool is_line() const { return positions_.is_line(); }
  [[nodiscard]] std::vector<double> seconds() const {
    if (!instants_.is_seconds()) return {};
    return {instants_.seconds().begin(), instants_.seconds().end()};
  }

  [[nodiscard]] Condition in_ticks(Condition condition) const {
    const int power = condition.kind == ConditionKind::acceleration ? 2 : 1;
    for (double& value : condition.value) value = scale_.scaled(value, -power);
    return condition;
  }

 private:
  void scale_seconds() {
    const auto seconds = instants_.seconds();
    require_increasing(seconds);
    scale_ = TimeScale(seconds);
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      ticks_.emplace_back(static_cast<std::int64_t>(scale_.ticks_of_seconds(seconds[i])));
      if (i == 0 || ticks_[i] > ticks_[i - 1]) continue;
      throw BadRequest("times[" + std::to_string(i) + "] = " + core::number_text(seconds[i]) +
                       " s is less than 2^-61 of the whole range after the time before it");
    }
  }

  std::span<const double> in_ticks(Rows& rows, int power, std::vector<double>& scratch) const {
    const auto given = rows.all();
    if (!scale_.is_seconds()) return given;
    for (const double value : given) scratch.push_back(scale_.scaled(value, -power));
    return scratch;
  }

  Instants instants_;
  Rows positions_;
  Rows velocities_;
  Rows accelerations_;
  TimeScale scale_;
  std::vector<Time> ticks_;
  std::vector<double> scaled_velocities_;
  std::vector<double> scaled_accelerations_;
  Waypoints waypoints_;
};

double cross_validated(const Mesh& mesh) {
  double lambda = 0;
  without_gil([&] { lambda = cross_validated_lambda(mesh.waypoints()); });
  return mesh.scale().scaled(lambda, -3);
}

struct Parameters {
  const std::string& method;
  py::handle start;
  py::handle end;
  std::optional<double> lambda;
  double time_scale = 1;
};

Curve fit_mesh(const Mesh& mesh, const Parameters& with) {
  Interpolant how{.method = &method(with.method), .time_scale = with.time_scale};
  FitFacts facts{.is_line = mesh.is_line(), .method = how.method, .seconds = mesh.seconds()};
  if (how.method->smooths()) {
    facts.lambda = with.lambda ? *with.lambda : cross_validated(mesh);
    how.lambda = *facts.lambda;
  }
  require_parameters(how);  // as given: the scaled ones would appear in messages
  how.lambda = std::min(mesh.scale().scaled(how.lambda, 3), kMostLambda);
  how.time_scale = std::clamp(mesh.scale().scaled(how.time_scale, 1), 1e-300, kMostLambda);
  const FitOptions options{.interpolant = how,
                           .start = mesh.in_ticks(condition(with.start)),
                           .end = mesh.in_ticks(condition(with.end))};
  PiecewisePolynomial polynomial(mesh.waypoints().dimensions);
  without_gil([&] { polynomial = splinecast::fit(mesh.waypoints(), options); });
  return {std::move(polynomial), mesh.scale(), std::move(facts)};
}

}  // namespace

void define_fit(py::module_& module) {
  module.def(
      "fit",
      [](py::handle times, py::handle positions, py::handle velocities, py::handle accelerations,
         const std::string& name, py::handle start, py::handle end, std::optional<double> lambda,
         double time_scale) {
        const Mesh mesh(times, positions, velocities, accelerations);
        return fit_mesh(mesh, {name, start, end, lambda, time_scale});
      },
      py::arg("times"), py::arg("positions"), py::arg("velocities") = py::none(),
      py::arg("accelerations") = py::none(), py::arg("method") = "c2",
      py::arg("start") = py::none(), py::arg("end") = py::none(), py::arg("lam") = py::none(),
      py::arg("time_scale") = 1.0, doc::fit);
  module.def(
      "cross_validated_lambda",
      [](py::handle times, py::handle positions) {
        return cross_validated(Mesh(times, positions, py::none(), py::none()));
      },
      py::arg("times"), py::arg("positions"), doc::cross_validated_lambda);
  module.def(
      "methods",
      [](bool streaming) {
        std::vector<std::string> names;
        for (const Method& known : splinecast::methods()) {
          if (known.streams() || !streaming) names.emplace_back(known.name);
        }
        return names;
      },
      py::arg("streaming") = false, doc::methods);
}

}  // namespace splinecast::python
