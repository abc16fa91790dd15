#include "apps/record/trigger/server.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/runtime_folder.hpp"
#include "apps/record/trigger/address.hpp"

namespace splinecast::apps::record {
namespace {

std::atomic<bool> has_signal{false};

void note_signal(int /*signal*/) { has_signal.store(true, std::memory_order_relaxed); }

/// Held while a socket is made, so that of two recorders with the same name one is refused.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder)
      : descriptor_(open((folder + "/splinecast.record.lock").c_str(),
                         O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
      throw Failure(fmt::format("cannot lock {}: {}", folder, std::strerror(errno)));
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }

 private:
  int descriptor_;
};

bool is_answered(const TriggerAddress& address) {
  const int probe = make_trigger_socket();
  const bool is_answered = connect(probe, address.get(), TriggerAddress::size()) == 0;
  close(probe);
  return is_answered;
}

/// Listens at the address of a recorder. Removes the file of one that was killed.
int listen_at(const TriggerAddress& address, const std::string& recorder) {
  if (is_answered(address)) {
    throw Failure(fmt::format("a recorder named '{}' is running", recorder));
  }
  unlink(address.path().c_str());
  const int made = make_trigger_socket();
  if (bind(made, address.get(), TriggerAddress::size()) == 0 && listen(made, SOMAXCONN) == 0 &&
      fcntl(made, F_SETFL, O_NONBLOCK) == 0) {
    return made;
  }
  const int error = errno;
  close(made);
  throw Failure(
      fmt::format("cannot listen for triggers at {}: {}", address.path(), std::strerror(error)));
}

/// Removes the sockets of processes that were killed.
void remove_stale(const std::string& folder) {
  constexpr std::string_view kBegin = "splinecast.record.";
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kBegin)) continue;
    const std::string process = name.substr(kBegin.size());
    const bool is_process = !process.empty() && std::ranges::all_of(process, [](char c) {
      return c >= '0' && c <= '9';
    });
    if (!is_process || std::filesystem::exists("/proc/" + process, error)) continue;
    unlink(entry.path().c_str());
  }
}

void close_all(std::vector<int>& connections) noexcept {
  for (const int connection : connections) close(connection);
  connections.clear();
}

}  // namespace

TriggerServer::TriggerServer(const std::string& name) {
  const std::string folder = own_runtime_folder();
  const FolderLock lock(folder);
  remove_stale(folder);
  const std::array names{std::to_string(getpid()), name};
  for (std::size_t i = 0; i < names.size() && !names.at(i).empty(); ++i) {
    try {
      const TriggerAddress address(folder, names.at(i));
      sockets_.at(i) = listen_at(address, names.at(i));
      paths_.at(i) = address.path();
    } catch (...) {
      if (sockets_[0] >= 0) close(sockets_[0]);
      if (!paths_[0].empty()) unlink(paths_[0].c_str());
      throw;
    }
  }
}

TriggerServer::~TriggerServer() {
  close_all(served_);
  close_all(waiting_);
  for (std::size_t i = 0; i < sockets_.size(); ++i) {
    if (sockets_.at(i) < 0) continue;
    unlink(paths_.at(i).c_str());
    close(sockets_.at(i));
  }
}

/// Takes the connections of this user and of root.
void TriggerServer::accept_all(int socket) {
  while (socket >= 0 && waiting_.size() < kMostWaiting) {
    const int connection = accept4(socket, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (connection < 0) return;
    const auto user = peer_of(connection);
    if (user && (*user == geteuid() || *user == 0)) {
      waiting_.push_back(connection);
    } else {
      close(connection);
    }
  }
}

bool TriggerServer::poll() {
  for (const int socket : sockets_) accept_all(socket);
  if (has_signal.exchange(false, std::memory_order_relaxed)) has_signal_ = true;
  if (is_busy_ || (waiting_.empty() && !has_signal_)) return false;
  is_busy_ = true;
  has_signal_ = false;
  served_ = std::exchange(waiting_, {});
  return true;
}

void TriggerServer::answer(bool is_done, const std::string& text) {
  is_busy_ = false;
  const std::string joined =
      served_.size() > 1 ? fmt::format(" ({} triggers joined)", served_.size()) : "";
  const std::string packet =
      fmt::format("{}{}{}", is_done ? '+' : '-', text, is_done ? joined : "");
  // A sender may have gone.
  for (const int connection : served_) {
    (void)send(connection, packet.data(), packet.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  close_all(served_);
}

void catch_trigger_signal() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  sigaction(SIGUSR1, &action, nullptr);
}

}  // namespace splinecast::apps::record
