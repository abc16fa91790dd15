#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/solvers/smoothing_rows.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/motions/stops.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::uint64_t kCuts = 200;

std::vector<Data> all_data() {
  constexpr double kQuantum = 1e-4;
  return {{"1 kHz in steps of 0.1 mrad", 1000, kQuantum},
          {"100 Hz in steps of 0.1 mrad", 100, kQuantum},
          {"100 Hz", 100, 0},
          {"30 Hz", 30, 0}};
}

/// Every tail of `c2`, and smoothing with about the largest λ whose lag fits into a window at 1
/// kHz.
std::vector<Curve> all_curves(double rate) {
  std::vector<Curve> curves;
  for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped}) {
    curves.push_back({fmt::format("c2, {}", to_string(tail)), {.tail = tail}});
  }
  constexpr double kLambda = 5e-7;
  core::WindowOptions smooth;
  smooth.interpolant = {.method = find_method("smoothing"), .lambda = kLambda};
  smooth.settle = static_cast<std::size_t>(std::ceil(core::smoothing_lag(kLambda, 1 / rate)) + 1);
  curves.push_back({"smoothing, lambda 5e-7 s3", smooth});
  return curves;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Text that docs/plots.py parses: "; " between quantities, ": " between name and value.
std::string text_of(const StopMeasures& m) {
  const std::string read = fmt::format(
      "time in entries, not measured: {:.1f} %; largest path error of a 1 kHz reader: {:.3g} mrad; "
      "largest acceleration of a 1 kHz reader: {:.3g} rad/s2",
      100 * static_cast<double>(m.in_entries) / static_cast<double>(m.in_entries + m.stops),
      1e3 * m.read_error, m.read_acceleration);
  if (m.stops == 0) return read;
  return fmt::format(
      "velocity error at newest knot p50: {:.3g} rad/s; velocity error at newest knot p99: {:.3g} "
      "rad/s; largest velocity error at newest knot: {:.3g} rad/s; distance of the "
      "stop beyond |v|T/2 p99: {:.3g} mrad; largest distance of the stop beyond |v|T/2: {:.3g} "
      "mrad; largest acceleration of the stop: {:.3g} rad/s2; largest jerk of the stop: {:.3g} "
      "rad/s3; largest acceleration of the last segment: {:.3g} rad/s2; path error of the last "
      "segment p99: {:.3g} mrad; largest path error of the last segment: {:.3g} mrad; largest "
      "overshoot of the last segment: {:.3g} mrad; {}",
      quantile(m.velocity_errors, 0.5), quantile(m.velocity_errors, 0.99), m.velocity_errors.back(),
      1e3 * quantile(m.runs_on, 0.99), 1e3 * m.runs_on.back(), m.stop_acceleration, m.stop_jerk,
      m.last_acceleration, 1e3 * quantile(m.last_path_errors, 0.99),
      1e3 * m.last_path_errors.back(), 1e3 * m.overshoot, read);
}

}  // namespace

Result run_stops(const CampaignOptions& options) {
  constexpr double kSame = 1e-12;  // rad
  const MonotonicClock clock;
  const Time begin = clock.now();
  const Sines motion(options.seed);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<> instant(2, 3);
  nlohmann::json measured;
  const std::uint64_t cuts = options.runs > 0 ? options.runs : kCuts;
  std::uint64_t stops = 0;
  std::uint64_t not_monotone = 0;
  std::uint64_t too_far = 0;
  std::uint64_t others = 0;
  for (const Data& data : all_data()) {
    for (const Curve& curve : all_curves(data.rate)) {
      const StopMeasures measures = measure_stops(motion, data, curve);
      for (std::uint64_t i = 0; i < cuts; ++i) {
        others += cut_off(motion, data, curve, instant(random)) > kSame ? 1U : 0U;
      }
      measured[fmt::format("{}; {}", data.name, curve.name)] = text_of(measures);
      stops += measures.stops + cuts;
      not_monotone += measures.not_monotone;
      too_far += measures.too_far;
    }
  }
  const nlohmann::json found{{"stops that speed up or reverse", not_monotone},
                             {"stops that move further than |v|T/2", too_far},
                             {"stops that end elsewhere than published", others}};
  return make_result(
      options, 4,
      "stops: the published stop of every tail when live waypoints, exact ones or those of "
      "encoders, end at any millisecond",
      stops, "stops of six joints", found, std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
