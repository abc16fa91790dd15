#pragma once

#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>

#include <optional>
#include <string>

namespace splinecast::apps::record {

/// Whether a text can be the name of a recorder: 1 to 64 characters of A-Z a-z 0-9 . _ -, not only
/// digits.
[[nodiscard]] bool is_recorder_name(const std::string& name) noexcept;

/// The address of a recorder's socket: a file in a folder that only its user can enter.
class TriggerAddress {
 public:
  /// `recorder`: its name or process id. Throws Failure if the path is too long for a socket.
  TriggerAddress(const std::string& folder, const std::string& recorder);

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] const sockaddr* get() const noexcept {
    return reinterpret_cast<const sockaddr*>(&value_);  // NOLINT(*-reinterpret-cast)
  }
  [[nodiscard]] static socklen_t size() noexcept { return sizeof(sockaddr_un); }

 private:
  std::string path_;
  sockaddr_un value_{};
};

/// A socket for triggers and their answers: packets, closed on exec. Throws Failure.
[[nodiscard]] int make_trigger_socket();

/// The user of the process at the other end of a connection; nothing if it is not known.
[[nodiscard]] std::optional<uid_t> peer_of(int connection) noexcept;

}  // namespace splinecast::apps::record
