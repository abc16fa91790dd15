#include "apps/fit/options.hpp"

#include <algorithm>
#include <string_view>

#include "apps/cli/conditions.hpp"
#include "apps/cli/options.hpp"

namespace splinecast::apps {

void add_curve(Command& verb, CurveOptions& options, const std::string& end_help) {
  add_method_options(verb, options.lambda, &options.lambda_is_auto, options.scale);
  add_condition(
      verb, "--start", options.start,
      "Boundary condition at the first waypoint (default: natural for c2, else the method's own)");
  add_end(verb, options.end, end_help);
  verb.flag("--online", options.online,
            "Fit online through the sliding window, as the solver does");
  add_online_options(verb, options.settle, options.tail, options.force_lag);
  add_gap(verb, options.gap);
}

void require_consistent(const CurveOptions& curve, std::span<const Method* const> methods) {
  const auto refuse = [](const char* name, const char* why) { throw UsageError(name, why); };
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(methods, [&](const auto* m) { return m->name == name; });
  };
  if (!curve.online && (curve.settle || curve.tail || curve.force_lag)) {
    refuse("--settle, --tail, --force-lag", "go with --online only");
  }
  if (curve.online && curve.lambda_is_auto) refuse("--lambda auto", "needs all waypoints at once");
  if ((curve.lambda || curve.lambda_is_auto) && !has("smoothing")) {
    refuse("--lambda", "goes with --method smoothing only");
  }
  if (curve.force_lag && !has("smoothing")) {
    refuse("--force-lag", "goes with --method smoothing only");
  }
  if (curve.scale && !has("rounded")) {
    refuse("--time-scale", "goes with --method rounded only");
  }
}

}  // namespace splinecast::apps
