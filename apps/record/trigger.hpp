#pragma once

#include <array>
#include <string>

namespace splinecast::apps::record {

/// Receives the triggers that `splinecast record --trigger` sends to this process: a socket without
/// a file, by the process id and, if there is one, by the recorder's name. It ends with the
/// process.
class TriggerSocket {
 public:
  /// `name` may be empty. Throws Failure if another recorder of this user has the name.
  explicit TriggerSocket(const std::string& name);
  TriggerSocket(const TriggerSocket&) = delete;
  TriggerSocket& operator=(const TriggerSocket&) = delete;
  ~TriggerSocket();

  /// Whether this user, or root, has sent a trigger since the last call. A system call for each
  /// trigger and one more.
  [[nodiscard]] bool take() noexcept;

 private:
  std::array<int, 2> sockets_{-1, -1};  ///< by process id, by name
};

/// Sends a trigger to the recorder with this name or process id. Throws NoSuchStream if there is
/// none.
void send_trigger(const std::string& recorder);

/// Whether a text can be the name of a recorder: 1 to 64 characters of A-Z a-z 0-9 . _ -, not only
/// digits.
[[nodiscard]] bool is_recorder_name(const std::string& name) noexcept;

/// Catches SIGUSR1, which is a trigger too.
void catch_trigger_signal();
/// Whether SIGUSR1 has arrived since the last call.
[[nodiscard]] bool take_trigger_signal() noexcept;

}  // namespace splinecast::apps::record
