#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace splinecast::apps::record {

/// Receives the triggers that `splinecast record --trigger` sends to this process, and SIGUSR1, and
/// answers with the file. Triggers that come before one is done are joined: one more file is for
/// all of them. One thread uses it.
class TriggerServer {
 public:
  /// Listens by the process id, and by `name` unless it is empty. Throws Failure if another
  /// recorder of this user has the name.
  explicit TriggerServer(const std::string& name);
  TriggerServer(const TriggerServer&) = delete;
  TriggerServer& operator=(const TriggerServer&) = delete;
  /// Connections without an answer are closed.
  ~TriggerServer();

  /// Whether a file should be begun now, for what has come so far. Not before answer() was called
  /// for the one before. A system call for each trigger and two more.
  [[nodiscard]] bool poll();

  /// Answers the triggers for which poll() returned true.
  void answer(bool is_done, const std::string& text);

 private:
  static constexpr std::size_t kMostWaiting = 256;

  void accept_all(int socket);

  std::array<std::string, 2> paths_;
  std::array<int, 2> sockets_{-1, -1};  ///< by process id, by name
  std::vector<int> waiting_;            ///< connections whose file has not been begun
  std::vector<int> served_;             ///< those for which it is being begun
  bool has_signal_ = false;
  bool is_busy_ = false;  ///< between poll() and answer()
};

/// Catches SIGUSR1, which is a trigger too.
void catch_trigger_signal();

}  // namespace splinecast::apps::record
