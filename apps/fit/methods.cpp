#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/files/polynomial_file.hpp"
#include "apps/fit/curve.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "splinecast/calculus.hpp"
#include "splinecast/method.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// Number of times per interval between waypoints at which a curve is compared with the truth.
constexpr int kComparisons = 100;
constexpr std::int64_t kMostWaypoints = 100'000;
constexpr double kUnmeasured = std::numeric_limits<double>::quiet_NaN();

struct MethodsOptions {
  std::vector<std::string> files;
  Time period{100'000'000};
  bool json = false;
};

/// A method and its settle lag; nullopt: in batch.
struct Choice {
  const Method* method;
  std::optional<std::size_t> settle;
  double lambda_per_h3 = 0;
};

/// Errors of a curve: the largest errors in p, v and a, relative to the largest p, v and a of the
/// truth, and the largest acceleration step, relative to the largest a of the truth. NaN if the
/// value of the truth is only rounding.
using Errors = std::array<double, 4>;

double largest(std::span<const double> values) {
  double most = 0;
  for (const double x : values) most = std::max(most, std::abs(x));
  return most;
}

std::vector<Choice> choices() {
  std::vector<Choice> all;
  for (const Method& method : methods()) {
    if (method.converges() && !method.smooths()) {
      for (const std::size_t settle : {0U, 1U, 2U, 4U, 8U, 16U}) all.push_back({&method, settle});
    } else if (method.smooths()) {
      all.push_back({&method, 16, 0.01});
    } else if (method.streams()) {
      all.push_back({&method, core::default_settle(method)});
    }
    if (method.converges() || !method.streams()) {
      all.push_back({&method, std::nullopt, method.laws.is_interpolating ? 0 : 0.01});
    }
  }
  return all;
}

/// The continuous stretches of a trajectory: splits it where its position jumps by 0.001 of its
/// unit or more, which no curve through waypoints can follow. Smaller jumps are rounding in the
/// file.
std::vector<PiecewisePolynomial> stretches(const PolynomialFile& file, const std::string& name,
                                           Time period) {
  constexpr double kRounding = 1e-3;
  const PiecewisePolynomial& curve = file.curve;
  std::vector<PiecewisePolynomial> all;
  std::vector<double> jump(curve.dimensions());
  Time from = curve.breaks().front();
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    curve.jump(i, 0, jump);
    if (largest(jump) < kRounding) continue;
    const Time at = curve.left_of(i);
    say(fmt::format("{}: the position jumps by {:.3g} at {} s: measured before and after it", name,
                    largest(jump), to_seconds(at)));
    all.push_back(restricted(curve, from, at));
    from = at;
  }
  all.push_back(restricted(curve, from, curve.breaks().back()));
  if ((curve.breaks().back() - curve.breaks().front()) / period > kMostWaypoints) {
    throw InputError(
        fmt::format("{}: more than {} waypoints: choose a longer --every", name, kMostWaypoints));
  }
  const auto is_too_short = [period](const PiecewisePolynomial& stretch) {
    return stretch.breaks().back() - stretch.breaks().front() < period;
  };
  if (std::erase_if(all, is_too_short) > 0) {
    say(fmt::format("{}: parts shorter than --every are skipped", name));
  }
  return all;
}

/// Waypoints every `period` from the first to the last instant, with their derivatives.
WaypointTable sampled(const PiecewisePolynomial& truth, Time period) {
  WaypointTable table;
  table.names.resize(truth.dimensions());
  State state(truth.dimensions());
  for (Time t = truth.breaks().front(); t <= truth.breaks().back(); t += period) {
    truth.evaluate(t, state.ref());
    table.times.push_back(t);
    table.lines.push_back(table.size());
    const auto append = [](std::vector<double>& to, std::span<const double> values) {
      to.insert(to.end(), values.begin(), values.end());
    };
    append(table.positions, state.position());
    append(table.velocities, state.velocity());
    append(table.accelerations, state.acceleration());
  }
  return table;
}

PiecewisePolynomial curve_of(const Choice& choice, const WaypointTable& table, Time period) {
  CurveOptions options;
  options.online = choice.settle.has_value();
  options.settle = choice.settle;
  const double h = to_seconds(period);
  if (choice.lambda_per_h3 > 0) options.lambda = choice.lambda_per_h3 * h * h * h;
  // Gives the velocities at both ends, because boundary effects are not measured here.
  const Method& method = *choice.method;
  if (method.streams() && !method.needs_velocity() && !method.smooths()) {
    const auto velocity = [&table](std::size_t i) {
      const auto v = table.waypoint(i).velocity;
      return Condition{ConditionKind::velocity, {v.begin(), v.end()}};
    };
    options.start = velocity(0);
    options.end = velocity(table.size() - 1);
  }
  return fit_table(table, *choice.method, options).curve;
}

Errors errors_of(const PiecewisePolynomial& curve, const PiecewisePolynomial& truth, Time period) {
  Errors errors{};
  Errors scale{};
  const std::size_t dimensions = curve.dimensions();
  State got(dimensions);
  State wanted(dimensions);
  const Time every = period / kComparisons;
  for (Time t = curve.breaks().front(); t <= curve.breaks().back(); t += every) {
    curve.evaluate(t, got.ref());
    truth.evaluate(t, wanted.ref());
    for (std::size_t i = 0; i < 3 * dimensions; ++i) {
      const std::size_t r = i / dimensions;
      errors[r] = std::max(errors[r], std::abs(got.values()[i] - wanted.values()[i]));
      scale[r] = std::max(scale[r], std::abs(wanted.values()[i]));
    }
  }
  scale[3] = scale[2];
  std::vector<double> step(dimensions);
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    curve.jump(i, 2, step);
    errors[3] = std::max(errors[3], largest(step));
  }
  constexpr double kRounding = 1e-9;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const std::size_t r = std::min<std::size_t>(k, 2);
    const double natural = r == 0 ? 0 : kRounding * scale[r - 1] / to_seconds(period);
    errors[k] = scale[k] > natural ? errors[k] / scale[k] : kUnmeasured;
  }
  return errors;
}

/// The largest errors of a choice over all trajectories.
Errors measured(const Choice& choice, Time period, const std::vector<PiecewisePolynomial>& truths) {
  Errors worst;
  worst.fill(kUnmeasured);
  for (const PiecewisePolynomial& truth : truths) {
    const WaypointTable table = sampled(truth, period);
    const Errors found = errors_of(curve_of(choice, table, period), truth, period);
    for (std::size_t k = 0; k < found.size(); ++k) worst[k] = std::fmax(worst[k], found[k]);
  }
  return worst;
}

ordered_json description(const Choice& choice) {
  const Method& method = *choice.method;
  ordered_json json{{"method", method.name},
                    {"settle", choice.settle ? ordered_json(*choice.settle) : ordered_json()},
                    {"order", method.order},
                    {"continuity", method.laws.continuity},
                    {"order_of_convergence", method.laws.order_of_convergence},
                    {"needs", method.needs_acceleration() ? "v, a"
                              : method.needs_velocity()   ? "v"
                                                          : ""}};
  if (choice.lambda_per_h3 > 0) json["lambda_per_h3"] = choice.lambda_per_h3;
  return json;
}

std::string text_row(const ordered_json& row) {
  std::string text =
      fmt::format("{:<11} {:>6} {:>5} {:>10} {:>11}  {:<4}", row["method"].get<std::string>(),
                  row["settle"].is_null() ? "all" : row["settle"].dump(), row["order"].dump(),
                  fmt::format("C^{}", row["continuity"].dump()), row["order_of_convergence"].dump(),
                  row["needs"].get<std::string>());
  if (!row.contains("errors")) return text + "\n";
  for (const double error : row["errors"].get<Errors>()) {
    text += std::isnan(error) ? fmt::format(" {:>9}", "-") : fmt::format(" {:>9.1e}", error);
  }
  return text + "\n";
}

int run_methods(const MethodsOptions& options) {
  std::vector<PiecewisePolynomial> truths;
  for (const std::string& file : options.files) {
    for (auto& stretch : stretches(read_polynomials(file), file, options.period)) {
      truths.push_back(std::move(stretch));
    }
  }
  if (truths.empty() && !options.files.empty()) {
    throw InputError("no trajectory lasts as long as --every");
  }
  ordered_json rows = ordered_json::array();
  for (const Choice& choice : choices()) {
    ordered_json row = description(choice);
    if (!truths.empty()) row["errors"] = measured(choice, options.period, truths);
    rows.push_back(std::move(row));
  }
  if (options.json) {
    print_report(rows.dump(2) + "\n");
    return kOk;
  }
  std::string text = fmt::format("{:<11} {:>6} {:>5} {:>10} {:>11}  {:<4}", "METHOD", "SETTLE",
                                 "ORDER", "CONTINUITY", "CONVERGENCE", "NEEDS");
  if (!truths.empty()) {
    text += fmt::format("{:>9} {:>9} {:>9} {:>9}", "P", "V", "A", "A STEP");
  }
  text += "\n";
  for (const ordered_json& row : rows) text += text_row(row);
  print_report(text);
  return kOk;
}

void add_methods(Command& verb, Action& action) {
  auto options = std::make_shared<MethodsOptions>();
  Argument against = verb.option(
      "--against", options->files,
      "Trajectories as polynomials (CSV: duration,x^0,x^1,...) to measure the methods "
      "against: largest errors in position, velocity and acceleration and largest "
      "acceleration step over all files, relative to the trajectory's largest position, "
      "velocity and acceleration");
  against.type("FILE...");
  add_seconds(verb, "--every", options->period,
              "Time between waypoints in s, from 1e-6 (default 0.1)",
              {std::chrono::microseconds(1), kLongestTime})
      .needs(against);
  verb.flag("--json", options->json, "Print JSON");
  verb.callback([&action, options] { action = [options] { return run_methods(*options); }; });
}

const Verb methods_verb("methods", 70,
                        "List the interpolants, and measure them against known trajectories",
                        add_methods);

}  // namespace

}  // namespace splinecast::apps
