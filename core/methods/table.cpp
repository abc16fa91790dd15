#include "splinecast/method.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "core/basics/number_text.hpp"
#include "core/batch/at_once.hpp"
#include "core/slopes/rule.hpp"
#include "core/solvers/families.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast {
namespace {

constexpr std::array kSolved{
    Method{.name = "c2",
           .number = 0,
           .solver = core::make_tridiagonal_solver,
           .fit_at_once = core::fit_c2,
           .traits = {.converges = true, .own_end = ConditionKind::halt},
           .laws = {.continuity = 2, .degree = 3, .order_of_convergence = 4}},
    Method{.name = "hermite",
           .number = 1,
           .solver = core::make_given_solver,
           .traits = {.needs_velocity = true, .has_own_tail = true},
           .look_ahead = 1,
           .laws = {.continuity = 1, .degree = 3, .order_of_convergence = 4}},
    Method{.name = "quintic",
           .number = 2,
           .solver = core::make_given_solver,
           .traits = {.needs_velocity = true, .has_own_tail = true},
           .order = kMaxOrder,
           .look_ahead = 1,
           .laws = {.continuity = 2, .degree = 5, .order_of_convergence = 6}},
    // Reproduces lines on regular meshes only: time is not a linear function of its parameter.
    Method{.name = "normalized",
           .number = 3,
           .fit_at_once = core::fit_normalized,
           .laws = {.continuity = 0, .degree = 0, .order_of_convergence = 4}},
    // The order is that of its limit λ → 0.
    Method{.name = "smoothing",
           .number = 4,
           .solver = core::make_smoothing_solver,
           .traits = {.converges = true, .has_own_tail = true, .smooths = true},
           .laws = {.continuity = 2,
                    .degree = 1,
                    .order_of_convergence = 4,
                    .is_interpolating = false}},
};

std::vector<Method> all_methods() {
  std::vector<Method> all(kSolved.begin(), kSolved.end());
  for (const core::SlopeRule& rule : core::slope_rules()) {
    all.push_back({.name = rule.name,
                   .number = rule.number,
                   .solver = core::make_local_solver,
                   .rule = &rule,
                   .look_ahead = static_cast<std::size_t>(rule.ahead),
                   .laws = rule.laws});
  }
  return all;
}

}  // namespace

std::span<const Method> methods() noexcept {
  static const std::vector<Method> kAll = all_methods();
  return kAll;
}

const Method& c2() noexcept { return methods().front(); }

const Method* find_method(std::string_view name) noexcept {
  const auto found = std::ranges::find(methods(), name, &Method::name);
  return found == methods().end() ? nullptr : &*found;
}

const Method* find_method(std::uint64_t number) noexcept {
  const auto found = std::ranges::find(methods(), number, &Method::number);
  return found == methods().end() ? nullptr : &*found;
}

std::string method_names(bool only_streaming) {
  std::string names;
  for (const Method& method : methods()) {
    if (only_streaming && !method.streams()) continue;
    if (!names.empty()) names += ", ";
    names += method.name;
  }
  return names;
}

void require_parameters(const Interpolant& interpolant) {
  if (!(interpolant.lambda >= 0 && is_usable(interpolant.lambda))) {
    throw std::invalid_argument("lambda must be 0 to 1e100, not " +
                                core::number_text(interpolant.lambda));
  }
  if (!(interpolant.time_scale > 0 && is_usable(interpolant.time_scale))) {
    throw std::invalid_argument("time scale must be above 0 and at most 1e100, not " +
                                core::number_text(interpolant.time_scale));
  }
}

}  // namespace splinecast
