#include "splinecast/solver.hpp"

#include <pybind11/stl.h>

#include <set>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/thread.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/records.hpp"
#include "ipc/python/values/times.hpp"
#include "ipc/python/values/types.hpp"
#include "ipc/python/waits.hpp"

namespace splinecast::python {
namespace {

class HeldSolver;

/// The solvers whose threads run, for the exit of the interpreter. Guarded by the GIL.
std::set<HeldSolver*>& running() {
  static auto* const solvers = new std::set<HeldSolver*>;  // never destroyed
  return *solvers;
}

/// The Python class Solver.
class HeldSolver {
 public:
  HeldSolver(const std::string& stream, const SolverOptions& options)
      : solver_("solver", stream, make_role<Solver>(stream, options)) {}
  HeldSolver(const HeldSolver&) = delete;
  HeldSolver& operator=(const HeldSolver&) = delete;

  ~HeldSolver() {
    running().erase(this);
    // A forked child has no such thread, and must not join it.
    if (solver_.is_foreign()) (void)thread_.release();
  }

  void start() {
    solver_.use([](const Solver&) {});
    if (is_running()) throw std::runtime_error("the thread of the " + name() + " already runs");
    thread_ = std::make_unique<SolverThread>(solver_);
    error_ = nullptr;
    running().insert(this);
  }

  /// Ends the thread and keeps its error.
  void end_thread() {
    solver_.require_own_process();
    running().erase(this);
    // The thread is moved here first: another Python thread may call this too.
    const std::unique_ptr<SolverThread> thread = std::move(thread_);
    if (!thread) return;
    without_gil([&thread] { thread->stop(); });
    error_ = thread->error();
  }

  void stop() {
    const bool had_thread = thread_ != nullptr;
    end_thread();
    if (had_thread && error_) std::rethrow_exception(error_);
  }

  void close() {
    end_thread();
    solver_.close();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

  void exit(const py::args& failure) {
    if (failure[0].is_none()) return close();
    end_thread();
    solver_.close();
  }

  bool attach() {
    return solver_.use([](Solver& solver) { return solver.attach(); });
  }

  py::object step() {
    StepResult result;
    solver_.require_own_process();
    without_gil([&] {
      result =
          solver_.use_without_gil([](Solver& solver) { return solver.step(MonotonicClock()); });
    });
    return to_record(result);
  }

  void wait(py::handle timeout) {
    constexpr Time kMost = kSignalSlice;
    const Time time = std::min(optional_duration(timeout, "timeout").value_or(kMost), kMost);
    solver_.require_own_process();
    without_gil([&] { solver_.use_without_gil([&](Solver& solver) { solver.wait(time); }); });
    check_signals();
  }

  py::list first_refusals() {
    std::vector<ItemRefusal> found;
    solver_.use([&](Solver& solver) { solver.take_first_refusals(found); });
    py::list items;
    for (const ItemRefusal& refusal : found) items.append(to_record(refusal, {}));
    return items;
  }

  py::object first_excess() {
    std::string text;
    const auto excess = solver_.use([&](Solver& solver) {
      auto found = solver.take_first_excess();
      if (found) text = solver.in_words(*found);
      return found;
    });
    if (!excess) return py::none();
    return to_record(*excess, text);
  }

  py::object error() const {
    const std::exception_ptr failure = thread_ ? thread_->error() : error_;
    if (!failure) return py::none();
    try {
      std::rethrow_exception(failure);
    } catch (const std::exception& known) {
      return to_exception(known);
    }
  }

  /// What a const function of Solver returns.
  template <auto Get>
  auto get() const {
    return solver_.use([](Solver& solver) { return (solver.*Get)(); });
  }

  [[nodiscard]] bool is_running() const {
    solver_.require_own_process();
    return thread_ != nullptr && thread_->is_running();
  }
  [[nodiscard]] bool is_closed() const { return solver_.is_closed(); }
  [[nodiscard]] const std::string& stream() const { return solver_.stream(); }
  [[nodiscard]] std::string name() const { return solver_.name(); }
  [[nodiscard]] std::string text() const {
    return "<splinecast.Solver '" + stream() + (is_closed() ? "', closed>" : "'>");
  }

 private:
  Held<Solver> solver_;
  std::exception_ptr error_;
  std::unique_ptr<SolverThread> thread_;  // ends before the solver
};

/// Ends all threads, at the exit of the interpreter.
void end_threads() {
  while (!running().empty()) {
    HeldSolver* const solver = *running().begin();
    running().erase(solver);
    try {
      solver->end_thread();
    } catch (const std::runtime_error&) {  // a forked child has no threads to end
    }
  }
}

using Class = py::class_<HeldSolver>;

void define_functions(Class& solver) {
  solver
      .def(
          "start",
          [](py::object self) {
            self.cast<HeldSolver&>().start();
            return self;
          },
          doc::Solver_start)
      .def("stop", &HeldSolver::stop, doc::Solver_stop)
      .def("close", &HeldSolver::close, doc::Solver_close)
      .def(
          "__enter__", [](py::object self) { return self; }, doc::Solver_enter)
      .def("__exit__", &HeldSolver::exit, doc::Solver_exit)
      .def("attach", &HeldSolver::attach, doc::Solver_attach)
      .def("step", &HeldSolver::step, doc::Solver_step)
      .def("wait", &HeldSolver::wait, py::arg("timeout") = py::none(), doc::Solver_wait)
      .def("first_refusals", &HeldSolver::first_refusals, doc::Solver_first_refusals)
      .def("first_excess", &HeldSolver::first_excess, doc::Solver_first_excess)
      .def("__repr__", &HeldSolver::text);
}

void define_properties(Class& solver) {
  solver.def_property_readonly("stream", &HeldSolver::stream, doc::Solver_stream)
      .def_property_readonly("attached", &HeldSolver::get<&Solver::attached>, doc::Solver_attached)
      .def_property_readonly("took_over", &HeldSolver::get<&Solver::took_over>,
                             doc::Solver_took_over)
      .def_property_readonly(
          "due", [](const HeldSolver& self) { return optional_ns(self.get<&Solver::due>()); },
          doc::Solver_due)
      .def_property_readonly("is_running", &HeldSolver::is_running, doc::Solver_is_running)
      .def_property_readonly("error", &HeldSolver::error, doc::Solver_error)
      .def_property_readonly("is_closed", &HeldSolver::is_closed, doc::Solver_is_closed)
      .def_property_readonly("is_memory_locked", &HeldSolver::get<&Solver::is_memory_locked>,
                             doc::Solver_is_memory_locked);
}

std::unique_ptr<HeldSolver> make(const std::string& stream, const py::object& method,
                                 const py::kwargs& keywords) {
  keywords["method"] = method;
  require_keywords(keywords, "Solver", solver_keywords());
  return std::make_unique<HeldSolver>(stream, solver_options(keywords));
}

}  // namespace

void define_solver(py::module_& module) {
  Class solver(module, "Solver", doc::Solver);
  solver.def(py::init(&make), py::arg("stream"), py::arg("method") = py::none(), doc::Solver_init);
  define_functions(solver);
  define_properties(solver);
  py::module_::import("atexit").attr("register")(py::cpp_function(end_threads));
}

}  // namespace splinecast::python
