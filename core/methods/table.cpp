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

/// A method, and how it is solved. It streams if it has a solver.
struct Row {
  Method method;
  core::Procedure procedure;
};

constexpr std::array kSolved{
    Row{.method = {.name = "c2",
                   .number = 0,
                   .traits = {.converges = true, .own_end = ConditionKind::halt},
                   .laws = {.continuity = 2, .degree = 3, .order_of_convergence = 4}},
        .procedure = {.solver = core::make_tridiagonal_solver, .fit_at_once = core::fit_c2}},
    Row{.method = {.name = "hermite",
                   .number = 1,
                   .traits = {.needs_velocity = true, .has_own_tail = true},
                   .look_ahead = 1,
                   .laws = {.continuity = 1, .degree = 3, .order_of_convergence = 4}},
        .procedure = {.solver = core::make_given_solver}},
    Row{.method = {.name = "quintic",
                   .number = 2,
                   .traits = {.needs_velocity = true, .has_own_tail = true},
                   .order = kMaxOrder,
                   .look_ahead = 1,
                   .laws = {.continuity = 2, .degree = 5, .order_of_convergence = 6}},
        .procedure = {.solver = core::make_given_solver}},
    // Reproduces lines on regular meshes only: time is not a linear function of its parameter.
    Row{.method = {.name = "normalized",
                   .number = 3,
                   .laws = {.continuity = 0, .degree = 0, .order_of_convergence = 4}},
        .procedure = {.fit_at_once = core::fit_normalized}},
    // The order is that of its limit λ → 0.
    Row{.method = {.name = "smoothing",
                   .number = 4,
                   .traits = {.converges = true, .has_own_tail = true, .smooths = true},
                   .laws = {.continuity = 2,
                            .degree = 1,
                            .order_of_convergence = 4,
                            .is_interpolating = false}},
        .procedure = {.solver = core::make_smoothing_solver}},
};

struct Table {
  std::vector<Method> methods;
  std::vector<core::Procedure> procedures;  ///< of the methods, in the same order

  void add(Row row) {
    row.method.traits.streams = row.procedure.solver != nullptr;
    methods.push_back(row.method);
    procedures.push_back(row.procedure);
  }
};

Table all_methods() {
  Table all;
  for (const Row& row : kSolved) all.add(row);
  for (const core::SlopeRule& rule : core::slope_rules()) {
    all.add({.method = {.name = rule.name,
                        .number = rule.number,
                        .look_ahead = static_cast<std::size_t>(rule.ahead),
                        .laws = rule.laws},
             .procedure = {.solver = core::make_local_solver, .rule = &rule}});
  }
  return all;
}

const Table& table() noexcept {
  static const Table kAll = all_methods();
  return kAll;
}

}  // namespace

std::span<const Method> methods() noexcept { return table().methods; }

const core::Procedure& core::procedure_of(const Method& method) noexcept {
  return table().procedures[static_cast<std::size_t>(&method - methods().data())];
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
