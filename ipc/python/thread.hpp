#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "ipc/python/held.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::python {

/// A thread that attaches a solver to its stream, steps it and waits, until it is stopped. It never
/// takes the GIL, and blocks all signals: Python handles them in the main thread.
class SolverThread {
 public:
  /// `solver` must outlive the thread.
  explicit SolverThread(const Held<Solver>& solver);
  SolverThread(const SolverThread&) = delete;
  SolverThread& operator=(const SolverThread&) = delete;
  ~SolverThread() { stop(); }

  /// Ends the thread. Blocks for a few milliseconds.
  void stop() noexcept;

  /// False after an error too.
  [[nodiscard]] bool is_running() const noexcept { return is_running_; }

  /// The error that ended the thread; null if there is none.
  [[nodiscard]] std::exception_ptr error() const;

 private:
  void run(const Held<Solver>& solver) noexcept;

  std::atomic<bool> must_stop_{false};
  std::atomic<bool> is_running_{true};
  mutable std::mutex mutex_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace splinecast::python
