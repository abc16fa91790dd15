#include "apps/record/trigger/send.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "apps/process/exit_codes.hpp"
#include "apps/process/runtime_folder.hpp"
#include "apps/record/trigger/address.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps::record {
namespace {

constexpr Time kPatience = std::chrono::seconds(60);

/// The user whose recorder is meant: root can mean the process of another one.
uid_t user_of(const std::string& recorder) {
  struct stat status {};
  const bool is_number = std::ranges::all_of(recorder, [](char c) { return c >= '0' && c <= '9'; });
  const bool is_found = geteuid() == 0 && is_number && !recorder.empty() &&
                        stat(fmt::format("/proc/{}", recorder).c_str(), &status) == 0;
  return is_found ? status.st_uid : geteuid();
}

class Connection {
 public:
  Connection() : descriptor_(make_trigger_socket()) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { close(descriptor_); }
  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

void connect_to(const Connection& connection, const std::string& recorder) {
  const uid_t user = user_of(recorder);
  for (const std::string& folder : runtime_folders(user)) {
    const TriggerAddress address(folder, recorder);
    if (connect(connection.get(), address.get(), TriggerAddress::size()) != 0) continue;
    const auto peer = peer_of(connection.get());
    if (peer && *peer == user) return;
    throw Failure(fmt::format("the socket of recorder '{}' belongs to another user",
                              ipc::printable(recorder)));
  }
  throw NoSuchStream(fmt::format("there is no recorder '{}'", ipc::printable(recorder)));
}

}  // namespace

std::string send_trigger(const std::string& recorder) {
  const Connection connection;
  connect_to(connection, recorder);
  const MonotonicClock clock;
  const Time end = clock.now() + kPatience;
  std::array<char, 8192> text{};
  for (;;) {
    if (clock.now() >= end) {
      throw TimeOut(fmt::format("recorder '{}' has the trigger, and has begun no file within {} s",
                                ipc::printable(recorder), kPatience / std::chrono::seconds(1)));
    }
    pollfd waits{.fd = connection.get(), .events = POLLIN, .revents = 0};
    constexpr int kPause = 100;  // ms
    if (::poll(&waits, 1, kPause) <= 0) continue;
    const ssize_t size = recv(connection.get(), text.data(), text.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) throw Failure(fmt::format("recorder '{}' ended", ipc::printable(recorder)));
    std::string answer(text.data() + 1, static_cast<std::size_t>(size) - 1);
    if (text[0] == '+') return answer;
    throw Failure(fmt::format("recorder '{}': {}", ipc::printable(recorder), answer));
  }
}

}  // namespace splinecast::apps::record
