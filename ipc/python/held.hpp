#pragma once

#include <pybind11/pybind11.h>
#include <sys/types.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

/// Access to the C++ objects inside Python objects: from the process that made them, by one thread
/// at a time.
namespace splinecast::python {

namespace py = pybind11;

/// The process that runs, also in a child just after fork(). No system call.
[[nodiscard]] pid_t current_process() noexcept;

/// Runs a function without the GIL. Restores the GIL outside of any destructor: at the exit of the
/// interpreter, Python ends a daemon thread there, which must not happen in a noexcept function.
template <typename Function>
void without_gil(const Function& function) {
  PyThreadState* const thread = PyEval_SaveThread();
  std::exception_ptr failure;
  try {
    function();
  } catch (const std::exception&) {
    failure = std::current_exception();
  }
  PyEval_RestoreThread(thread);
  if (failure) std::rethrow_exception(failure);
}

/// A lock whose waiting threads get their turn in order of arrival. A thread may wait for the GIL
/// while it holds the lock, but not the other way round: that could be a deadlock.
class TurnLock {
 public:
  [[nodiscard]] bool try_lock() noexcept {
    unsigned turn = serving_.load(std::memory_order_acquire);
    return next_.compare_exchange_strong(turn, turn + 1, std::memory_order_acquire);
  }

  /// Blocks. Requires that the thread does not hold the GIL.
  void lock() noexcept {
    const unsigned turn = next_.fetch_add(1, std::memory_order_relaxed);
    for (unsigned now = serving_.load(std::memory_order_acquire); now != turn;
         now = serving_.load(std::memory_order_acquire)) {
      serving_.wait(now, std::memory_order_relaxed);
    }
  }

  void unlock() noexcept {
    serving_.fetch_add(1, std::memory_order_release);
    serving_.notify_all();
  }

 private:
  std::atomic<unsigned> next_{0};
  std::atomic<unsigned> serving_{0};
};

/// Holds a TurnLock. The constructor requires the GIL, and releases it while it waits.
class Turn {
 public:
  explicit Turn(TurnLock& lock) : lock_(lock) {
    if (!lock.try_lock()) without_gil([&lock] { lock.lock(); });
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  ~Turn() { lock_.unlock(); }

 private:
  TurnLock& lock_;
};

/// Makes a role without the GIL: a constructor may wait for a lock.
template <typename Role, typename... Arguments>
std::unique_ptr<Role> make_role(const Arguments&... arguments) {
  std::unique_ptr<Role> role;
  without_gil([&] { role = std::make_unique<Role>(arguments...); });
  return role;
}

/// A role of a stream that a Python object holds until it is closed.
template <typename Role>
class Held {
 public:
  Held(const char* kind, std::string stream, std::unique_ptr<Role> role)
      : kind_(kind), stream_(std::move(stream)), role_(std::move(role)) {}
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  /// A forked child leaks the role: its mappings and locks belong to the parent.
  ~Held() {
    if (is_foreign()) (void)role_.release();
  }

  /// Calls a function with the role, while no other thread uses it. The function must not run
  /// Python code, which could use the role again.
  template <typename Use>
  auto use(const Use& use) const {
    require_own_process();
    const Turn turn(lock_);
    return use(open());
  }

  /// The same for a thread without the GIL.
  template <typename Use>
  auto use_without_gil(const Use& use) const {
    const std::lock_guard turn(lock_);
    return use(open());
  }

  void close() {
    require_own_process();
    const Turn turn(lock_);
    role_.reset();
  }

  /// Throws std::runtime_error in a forked child.
  void require_own_process() const {
    if (!is_foreign()) return;
    throw std::runtime_error("the " + name() + " was created before fork in process " +
                             std::to_string(process_) + ", and only that process can use it");
  }

  [[nodiscard]] bool is_foreign() const noexcept { return process_ != current_process(); }
  [[nodiscard]] bool is_closed() const noexcept { return role_ == nullptr; }
  [[nodiscard]] const std::string& stream() const noexcept { return stream_; }
  [[nodiscard]] std::string name() const { return kind_ + (" of '" + stream_ + "'"); }

 private:
  [[nodiscard]] Role& open() const {
    if (!role_) throw std::runtime_error("the " + name() + " is closed");
    return *role_;
  }

  const char* kind_;
  std::string stream_;
  std::unique_ptr<Role> role_;
  mutable TurnLock lock_;
  pid_t process_ = current_process();
};

}  // namespace splinecast::python
