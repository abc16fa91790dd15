#include "apps/fit/curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include "apps/fit/pieces.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "core/solvers/smoothing_rows.hpp"
#include "splinecast/fit.hpp"

namespace splinecast::apps {
namespace {

constexpr ConditionKind kOwn = ConditionKind::own;

Condition or_own(const std::optional<Condition>& condition) {
  return condition.value_or(Condition{.kind = kOwn, .value = {}});
}

/// Throws InputError if the method needs a derivative that the file lacks or that is not a usable
/// number.
void require_derivatives(const WaypointTable& table, const Method& method) {
  const auto require = [&](bool needed, const std::vector<double>& values, char letter) {
    if (!needed) return;
    if (values.empty()) {
      throw InputError(fmt::format("{}: method {} needs columns {}[0] to {}[{}]", table.file,
                                   method.name, letter, letter, table.dimensions() - 1));
    }
    const auto bad = std::ranges::find_if_not(values, is_usable);
    if (bad == values.end()) return;
    const auto at = static_cast<std::size_t>(bad - values.begin());
    throw InputError(fmt::format("{}: column '{}[{}]': {} is not finite, or beyond 1e100",
                                 table.where(at / table.dimensions()), letter,
                                 at % table.dimensions(), *bad));
  };
  require(method.needs_velocity(), table.velocities, 'v');
  require(method.needs_acceleration(), table.accelerations, 'a');
}

double chosen_lambda(const Waypoints& waypoints, const CurveOptions& options) {
  if (options.lambda) return *options.lambda;
  if (options.online) {
    throw std::invalid_argument(
        "method smoothing needs --lambda with --online: cross-validation needs all waypoints");
  }
  const double lambda = cross_validated_lambda(waypoints);
  say(fmt::format("lambda {} chosen by cross-validation", lambda));
  return lambda;
}

[[noreturn]] void throw_lag_too_short(const WaypointTable& table, std::size_t i,
                                      const core::WindowOptions& how) {
  const double ahead = to_seconds(table.times[i] - table.times[i - how.settle]);
  const double mean = ahead / static_cast<double>(how.settle);
  throw InputError(fmt::format(
      "{}: settle lag {} is too short for lambda {} with waypoints {:.3g} s apart: at least {} is "
      "needed (the maximum is {}); --force-lag accepts it",
      table.where(i), how.settle, how.interpolant.lambda, mean,
      static_cast<std::size_t>(std::ceil(core::smoothing_lag(how.interpolant.lambda, mean))),
      core::kMaxSettle));
}

/// Feeds the waypoints through the sliding window, as the solver does, and keeps each segment as it
/// settles. `end`: null for the tail of a stream that continues.
PiecewisePolynomial fit_online(const WaypointTable& table, const core::WindowOptions& how,
                               const Condition* end) {
  core::SlidingWindow window(table.dimensions(), how);
  if (end != nullptr) require_values(*end, table.dimensions());
  if (end != nullptr && !is_online(end->kind)) {
    throw std::invalid_argument("condition '" + to_string(*end) +
                                "' needs all waypoints at once: it cannot be met online");
  }
  PiecewisePolynomial curve(table.dimensions());
  core::Segment segment(table.dimensions());
  const auto take = [&](std::size_t segments) {
    while (curve.segments() < segments) {
      window.segment(curve.segments(), segment);
      core::append(segment, curve);
    }
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!window.lag_suffices(table.times[i])) throw_lag_too_short(table, i, how);
    window.append(table.waypoint(i));
    take(window.settled_segments());
  }
  if (end != nullptr) window.finish(*end);
  take(end != nullptr ? window.settled_segments() : window.knots() - 1);
  return curve;
}

/// The velocity at the end of a c2 stream that continues: the slope of the parabola through its
/// last three waypoints.
Condition tail_of(const WaypointTable& table) {
  const std::size_t count = std::min<std::size_t>(table.size(), 3);
  const WaypointTable last = part_of(table, table.size() - count, count);
  const PiecewisePolynomial parabola =
      fit(last.waypoints(), {.interpolant = {.method = find_method("bessel")}});
  Condition tail{.kind = ConditionKind::velocity, .value = std::vector<double>(table.dimensions())};
  parabola.derivative(last.times.back(), 1, tail.value);
  return tail;
}

/// A table without gaps, and how it is fitted.
class PieceFit {
 public:
  PieceFit(const WaypointTable& table, const Method& method, const CurveOptions& options)
      : table_(table), options_(options), how_{&method, 0, options.scale.value_or(1)} {
    require_derivatives(table, method);
    if (method.smooths()) how_.lambda = chosen_lambda(table.waypoints(), options);
    if (options.online && options.tail && method.has_own_tail()) {
      throw std::invalid_argument("the tail of method " + std::string(method.name) + " is fixed");
    }
  }

  /// The curve with a condition at its end.
  [[nodiscard]] PiecewisePolynomial ended(const Condition& end) const {
    if (options_.online) return fit_online(table_, window(), &end);
    return fit(table_.waypoints(),
               {.interpolant = how_, .start = or_own(options_.start), .end = end});
  }

  /// The curve while it continues, as far as its last waypoint. Requires two waypoints.
  [[nodiscard]] PiecewisePolynomial continued() const {
    if (options_.online) return fit_online(table_, window(), nullptr);
    return ended(how_.method == &c2() ? tail_of(table_) : Condition{.kind = kOwn, .value = {}});
  }

  /// The number of last segments that an end may change.
  [[nodiscard]] std::size_t open() const {
    return options_.settle.value_or(core::default_settle(*how_.method)) + 1;
  }

 private:
  [[nodiscard]] core::WindowOptions window() const {
    return {.interpolant = how_,
            .settle = options_.settle.value_or(core::default_settle(*how_.method)),
            .tail = options_.tail.value_or(Tail::bessel),
            .start = or_own(options_.start),
            .accepts_short_lag = options_.force_lag};
  }

  const WaypointTable& table_;
  const CurveOptions& options_;
  Interpolant how_;
};

FittedCurve fit_piece(const WaypointTable& table, const Method& method,
                      const CurveOptions& options) {
  const PieceFit piece(table, method, options);
  if (options.end && std::holds_alternative<AtRest>(*options.end)) {
    const PiecewisePolynomial halted = piece.ended({.kind = ConditionKind::halt, .value = {}});
    if (halted.is_hold()) return {halted, ipc::EndKind::as_requested};
    return rest_at_last(halted, piece.continued(), table.waypoints(), options.rest, piece.open());
  }
  const Condition* given = condition_of(options.end);
  const Condition end = given != nullptr ? *given : Condition{.kind = kOwn, .value = {}};
  DimensionKinds(table.kinds).require_end(end);
  return {piece.ended(end)};
}

/// Throws InputError if a method or a condition does not allow a halt at a gap.
void require_halts(const WaypointTable& table, const Method& method, const CurveOptions& options) {
  const Condition* end = condition_of(options.end);
  const bool is_periodic = (options.start && options.start->kind == ConditionKind::periodic) ||
                           (end != nullptr && end->kind == ConditionKind::periodic);
  const bool is_normalized = method.name == "normalized";
  if (!is_normalized && !is_periodic) return;
  throw InputError(fmt::format("{}: has gaps, and {} cannot halt at them: use --gap bridge",
                               table.file,
                               is_normalized ? "method normalized" : "a periodic curve"));
}

/// Fits each piece between gaps, at rest where it meets a gap, and joins them.
FittedCurve fit_pieces(const WaypointTable& table, const Method& method, CurveOptions options,
                       const std::vector<std::size_t>& starts) {
  require_halts(table, method, options);
  if (method.smooths()) options.lambda = chosen_lambda(table.waypoints(), options);
  const Condition halt{.kind = ConditionKind::halt, .value = {}};
  std::vector<PiecewisePolynomial> curves;
  FittedCurve last{PiecewisePolynomial(table.dimensions())};
  for (std::size_t k = 0; k <= starts.size(); ++k) {
    const std::size_t begin = k == 0 ? 0 : starts[k - 1];
    const std::size_t end = k == starts.size() ? table.size() : starts[k];
    CurveOptions piece = options;
    if (k > 0) piece.start = halt;
    if (k < starts.size()) piece.end = halt;
    last = fit_piece(part_of(table, begin, end - begin), method, piece);
    curves.push_back(last.curve);
  }
  last.curve = join(curves);
  return last;
}

}  // namespace

FittedCurve fit_table(const WaypointTable& table, const Method& method,
                      const CurveOptions& options) {
  const std::vector<std::size_t> starts = find_gaps(table, options.gap).starts;
  return starts.empty() ? fit_piece(table, method, options)
                        : fit_pieces(table, method, options, starts);
}

}  // namespace splinecast::apps
