#include "apps/record/trigger.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "apps/process/exit_codes.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps::record {
namespace {

std::atomic<bool> has_signal{false};

void note_signal(int /*signal*/) { has_signal.store(true, std::memory_order_relaxed); }

/// The address of a recorder's socket: in the abstract namespace, which has no files.
struct Address {
  sockaddr_un value{};
  socklen_t size = 0;

  explicit Address(std::string_view name) {
    const std::string text = fmt::format("splinecast.record.{}.{}", geteuid(), name);
    value.sun_family = AF_UNIX;
    std::memcpy(value.sun_path + 1, text.data(), text.size());
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  }
  [[nodiscard]] const sockaddr* get() const noexcept {
    return reinterpret_cast<const sockaddr*>(&value);  // NOLINT(*-reinterpret-cast)
  }
};

int make_socket() {
  const int made = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (made < 0) throw Failure(fmt::format("no socket: {}", std::strerror(errno)));
  return made;
}

int listen_at(const std::string& name) {
  const int made = make_socket();
  const int on = 1;
  const Address address(name);
  if (setsockopt(made, SOL_SOCKET, SO_PASSCRED, &on, sizeof on) == 0 &&
      bind(made, address.get(), address.size) == 0) {
    return made;
  }
  const int error = errno;
  close(made);
  if (error == EADDRINUSE) throw Failure(fmt::format("a recorder named '{}' is running", name));
  throw Failure(fmt::format("cannot listen for triggers: {}", std::strerror(error)));
}

/// Takes one datagram. Returns whether there was one; `is_trusted`: from this user or from root.
bool receive(int socket, bool& is_trusted) noexcept {
  char byte = 0;
  iovec data{.iov_base = &byte, .iov_len = 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(ucred))> control{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  if (recvmsg(socket, &message, MSG_DONTWAIT) < 0) return false;
  const cmsghdr* const header = CMSG_FIRSTHDR(&message);
  ucred sender{.pid = 0, .uid = static_cast<uid_t>(-1), .gid = 0};
  if (header != nullptr && header->cmsg_type == SCM_CREDENTIALS) {
    std::memcpy(&sender, CMSG_DATA(header), sizeof sender);
  }
  is_trusted = sender.uid == geteuid() || sender.uid == 0;
  return true;
}

}  // namespace

TriggerSocket::TriggerSocket(const std::string& name) {
  sockets_[0] = listen_at(std::to_string(getpid()));
  if (name.empty()) return;
  try {
    sockets_[1] = listen_at(name);
  } catch (...) {
    close(sockets_[0]);
    throw;
  }
}

TriggerSocket::~TriggerSocket() {
  for (const int socket : sockets_) {
    if (socket >= 0) close(socket);
  }
}

bool TriggerSocket::take() noexcept {
  constexpr int kMost = 64;  // bounds a call while a sender floods it
  bool has_any = false;
  for (const int socket : sockets_) {
    bool is_trusted = false;
    for (int n = 0; socket >= 0 && n < kMost && receive(socket, is_trusted); ++n) {
      has_any = has_any || is_trusted;
    }
  }
  return has_any;
}

void send_trigger(const std::string& recorder) {
  const int socket = make_socket();
  const Address address(recorder);
  const ssize_t sent = sendto(socket, "t", 1, 0, address.get(), address.size);
  const int error = errno;
  close(socket);
  if (sent == 1 || error == EAGAIN) return;  // a full queue holds triggers already
  if (error == ECONNREFUSED) {
    throw NoSuchStream(fmt::format("there is no recorder '{}'", ipc::printable(recorder)));
  }
  throw Failure(fmt::format("cannot reach recorder '{}': {}", ipc::printable(recorder),
                            std::strerror(error)));
}

bool is_recorder_name(const std::string& name) noexcept {
  constexpr std::size_t kMost = 64;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_allowed = [&](char c) {
    return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= kMost && std::ranges::all_of(name, is_allowed) &&
         !std::ranges::all_of(name, is_digit);
}

void catch_trigger_signal() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  sigaction(SIGUSR1, &action, nullptr);
}

bool take_trigger_signal() noexcept {
  return has_signal.exchange(false, std::memory_order_relaxed);
}

}  // namespace splinecast::apps::record
