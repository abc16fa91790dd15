#pragma once

#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

namespace splinecast::apps {

/// A child process that runs a function and hands its result back as JSON through a pipe. It dies
/// with its parent.
class Child {
 public:
  /// Forks at once. The child does not get the terminal's Ctrl-C: its parent passes a stop on.
  explicit Child(const std::function<nlohmann::json()>& run);
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;
  /// Kills it if it has not been waited for.
  ~Child();

  /// Waits for the child's end and returns its result. A stop that is requested meanwhile is passed
  /// on to it, and kills it 3 s later if it still runs. Throws Failure if it failed or was killed,
  /// Interrupted if a stop was requested.
  nlohmann::json result();

  /// Whether it has ended, and then how: its exit code, or minus the number of the signal that
  /// killed it. Once it has, there is nothing more to be asked of it.
  [[nodiscard]] std::optional<int> ended() noexcept;
  /// Its process id; -1 once it has been waited for.
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

  /// Sends it a signal; to kill it, destroy this object.
  void signal(int number) const noexcept;

  /// Asks the child to end (SIGTERM); only the first call does anything.
  void stop() noexcept;

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
  bool told_to_end_ = false;
};

}  // namespace splinecast::apps
