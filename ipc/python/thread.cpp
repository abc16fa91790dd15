#include "ipc/python/thread.hpp"

#include <csignal>

#include "ipc/python/waits.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::python {
namespace {

/// Blocks all signals of this thread; the threads that it starts inherit that.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

void turn(Solver& solver, const Clock& clock) {
  if (!solver.attached()) (void)solver.attach(clock);
  const StepResult result = solver.step(clock);
  if (result.consumed == 0 && !result.missed) solver.wait(kTurnSlice);
}

}  // namespace

SolverThread::SolverThread(const Held<Solver>& solver) {
  const BlockedSignals blocked;
  thread_ = std::thread([this, &solver] { run(solver); });
}

void SolverThread::run(const Held<Solver>& solver) noexcept {
  const MonotonicClock clock;
  try {
    while (!must_stop_) {
      solver.use_without_gil([&](Solver& role) { turn(role, clock); });
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    error_ = std::current_exception();
  }
  is_running_ = false;
}

void SolverThread::stop() noexcept {
  must_stop_ = true;
  if (thread_.joinable()) thread_.join();
}

std::exception_ptr SolverThread::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace splinecast::python
