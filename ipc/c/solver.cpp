#include <optional>
#include <string>

#include "ipc/arguments/options.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/c/roles.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

/// Runs the body of a function with the solver of a handle.
template <typename Body>
int with(splinecast_solver* solver, const Body& body) noexcept {
  return guarded([&] { return body(require_handle(solver, "solver")); });
}

}  // namespace

extern "C" {

int splinecast_solver_create(const char* stream, const splinecast_solver_options* options,
                             splinecast_solver** out) {
  return create_handle(out, [&] {
    return new splinecast_solver(std::string(require_text(stream, "stream")),
                                 solver_options(options));
  });
}

int splinecast_solver_destroy(splinecast_solver* solver) {
  return destroy_handle(solver, "solver");
}

int splinecast_solver_attach(splinecast_solver* solver) {
  return with(solver, [](splinecast_solver& own) -> int { return own.solver.attach(own.clock); });
}

int splinecast_solver_step(splinecast_solver* solver, splinecast_step_result* out) {
  return with(solver, [&](splinecast_solver& own) {
    if (out != nullptr) require_size(out, sizeof(splinecast_step_result), "out");
    const StepResult step = own.solver.step(own.clock);
    if (out != nullptr) {
      write_struct({.size = sizeof(splinecast_step_result),
                    .consumed = step.consumed,
                    .published = step.published ? 1 : 0,
                    .missed = step.missed ? 1 : 0,
                    .damaged = step.damaged ? 1 : 0,
                    .reserved = 0},
                   out);
    }
    return step.consumed > 0 || step.missed ? 1 : 0;
  });
}

int splinecast_solver_wait(splinecast_solver* solver, int64_t timeout) {
  return with(solver, [&](splinecast_solver& own) {
    own.solver.wait(timeout_of(timeout));
    return 0;
  });
}

int splinecast_solver_due(splinecast_solver* solver, int64_t* time) {
  return with(solver, [&](splinecast_solver& own) {
    *require_pointer(time, "time") = own.solver.due().count();
    return 0;
  });
}

int splinecast_solver_attached(splinecast_solver* solver) {
  return with(solver, [](splinecast_solver& own) -> int { return own.solver.attached(); });
}

int splinecast_solver_took_over(splinecast_solver* solver) {
  return with(solver, [](splinecast_solver& own) -> int { return own.solver.took_over(); });
}

int splinecast_solver_is_memory_locked(splinecast_solver* solver) {
  return with(solver, [](splinecast_solver& own) -> int { return own.solver.is_memory_locked(); });
}

int splinecast_solver_first_refusals(splinecast_solver* solver, splinecast_refusals* out) {
  return with(solver, [&](splinecast_solver& own) {
    return own.refused.deliver(
        out, [&](Refusals& found) { own.solver.take_first_refusals(found.items); });
  });
}

int splinecast_solver_first_excess(splinecast_solver* solver, splinecast_limit_excess* out) {
  return with(solver, [&](splinecast_solver& own) {
    require_pointer(out, "out");
    const std::optional<LimitExcess> first = own.solver.take_first_excess();
    if (first) *out = limit_excess_of(*first);
    return first ? 1 : 0;
  });
}

}  // extern "C"
