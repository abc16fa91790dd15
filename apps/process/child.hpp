#pragma once

#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

namespace splinecast::apps {

/// A child process that runs a function and returns its result as JSON through a pipe. It gets
/// SIGTERM when its parent dies.
class Child {
 public:
  /// Forks at once. The child has its own process group, so that Ctrl-C does not reach it: the
  /// parent forwards a stop. Throws Failure.
  explicit Child(const std::function<nlohmann::json()>& run);
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;
  /// Kills the child and waits for it, unless it has been waited for.
  ~Child();

  /// Waits for the child to end and returns its result. Forwards a stop request to the child, and
  /// kills the child 20 s later if it still runs. Throws Failure if the child failed or was killed,
  /// Interrupted if a stop was requested.
  nlohmann::json result();

  /// The exit code of the child, or minus the number of the signal that killed it; nothing while it
  /// runs. Returns the code once: then the child has been waited for.
  [[nodiscard]] std::optional<int> ended() noexcept;
  /// The process id; -1 after the child has been waited for.
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

  /// Sends the child a signal. To kill the child, destroy this object.
  void signal(int number) const noexcept;

  /// Requests the child to end (SIGTERM). Only the first call has an effect.
  void stop() noexcept;

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
  bool end_requested_ = false;
};

}  // namespace splinecast::apps
