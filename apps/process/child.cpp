#include "apps/process/child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"

namespace splinecast::apps {
namespace {

/// Time from a stop signal to the parent until it kills its children. Long enough for a child that
/// has to wait for a CPU. The parent extends its own limit meanwhile, so that it can still clean
/// up.
constexpr Time kGrace = std::chrono::seconds(20);

/// Returns false if the other end is closed.
bool write_all(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(pipe, text.data(), text.size());
    if (written < 0 && errno != EINTR) return false;
    text.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

[[noreturn]] void run_child(const std::function<nlohmann::json()>& run, int pipe, pid_t parent) {
  int code = kOk;
  try {
    catch_stop_signals_as_child_of(parent);
    if (!write_all(pipe, run().dump())) code = kFailed;
  } catch (const Interrupted&) {
    code = kInterrupted;  // the parent prints the message
  } catch (const std::exception& error) {
    say(error.what());
    code = kFailed;
  }
  _exit(code);  // must not flush the parent's buffers or destroy its objects
}

}  // namespace

Child::Child(const std::function<nlohmann::json()>& run) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Failure("cannot create a pipe for a child process");
  std::fflush(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) {
    for (const int end : ends) close(end);
    throw Failure("cannot fork a child process");
  }
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(kFailed);
    setpgid(0, 0);
    close(ends[0]);
    run_child(run, ends[1], parent);
  }
  close(ends[1]);
  pipe_ = ends[0];
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      pipe_(std::exchange(other.pipe_, -1)),
      end_requested_(other.end_requested_) {}

Child::~Child() {
  if (pipe_ >= 0) close(pipe_);
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

nlohmann::json Child::result() {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    if (stop_requested()) stop();
    extend_shutdown();
    if (time_since_stop() > kGrace) signal(SIGKILL);
    constexpr int kSliceMilliseconds = 100;
    pollfd ready{.fd = pipe_, .events = POLLIN, .revents = 0};
    const int found = poll(&ready, 1, kSliceMilliseconds);
    if (found < 0 && errno != EINTR) throw Failure("cannot wait for a child process");
    if (found <= 0) continue;
    const ssize_t got = read(pipe_, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != kOk) {
    if (stop_requested()) throw Interrupted("interrupted");
    throw Failure(fmt::format("a child process ended with {} {}",
                              WIFSIGNALED(status) ? "signal" : "code",
                              WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status)));
  }
  return nlohmann::json::parse(text);
}

std::optional<int> Child::ended() noexcept {
  int status = 0;
  if (pid_ < 0 || waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  pid_ = -1;
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

void Child::signal(int number) const noexcept {
  if (pid_ > 0) kill(pid_, number);
}

void Child::stop() noexcept {
  if (!std::exchange(end_requested_, true))
    signal(SIGTERM);  // a second SIGTERM would kill the child
}

}  // namespace splinecast::apps
