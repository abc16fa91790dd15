#include "support/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/stream_files.hpp"

namespace splinecast::testing {
namespace {

using std::chrono::steady_clock;

/// Appends what a pipe holds to a text. Returns false at its end.
bool drain(int pipe, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t got = read(pipe, buffer.data(), buffer.size());
  if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
  return got > 0;
}

std::string unique_name(const char* prefix) {
  static std::atomic<int> count{0};
  const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(prefix) + std::to_string(getpid()) + "." +
                     std::to_string(count++) + "." + (test != nullptr ? test->name() : "");
  for (char& c : name) {
    if (c == '/') c = '-';
  }
  return name.substr(0, 120);
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments)
    : Process(SPLINECAST_PROGRAM, arguments) {}

Process::Process(const std::string& program, const std::vector<std::string>& arguments) {
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    // What the tests' own parent left open must not count against a limit that a test sets.
    close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
}

Process::Process(Process&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      out_(std::exchange(other.out_, -1)),
      err_(std::exchange(other.err_, -1)),
      out_text_(std::move(other.out_text_)),
      err_text_(std::move(other.err_text_)) {}

Process::~Process() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (out_ >= 0) close(out_);
  if (err_ >= 0) close(err_);
}

void Process::signal(int number) const { kill(pid_, number); }

/// Reads what has come on either pipe, waiting a little. Returns false when both have ended.
bool Process::read_some() {
  std::array<pollfd, 2> pipes{pollfd{.fd = out_, .events = POLLIN, .revents = 0},
                              pollfd{.fd = err_, .events = POLLIN, .revents = 0}};
  poll(pipes.data(), pipes.size(), 100);
  if (pipes[0].revents != 0 && !drain(out_, out_text_)) close(std::exchange(out_, -1));
  if (pipes[1].revents != 0 && !drain(err_, err_text_)) close(std::exchange(err_, -1));
  return out_ >= 0 || err_ >= 0;
}

void Process::await_message(const std::string& text) {
  await_until([&] { return err_text_.find(text) != std::string::npos; }, text);
}

void Process::await_lines(std::ptrdiff_t count) {
  await_until([&] { return std::ranges::count(out_text_, '\n') >= count; },
              std::to_string(count) + " lines");
}

void Process::await_until(const std::function<bool()>& is_there, const std::string& wanted) {
  const auto end = steady_clock::now() + kPatience;
  while (!is_there()) {
    if (!read_some() || steady_clock::now() > end) {
      FAIL() << "never said '" << wanted << "' but '" << err_text_ << out_text_ << "'";
    }
  }
}

Ended Process::wait() {
  const auto end = steady_clock::now() + 2 * kPatience;
  while (read_some()) {
    if (steady_clock::now() <= end) continue;
    ADD_FAILURE() << "process hangs; it said '" << err_text_ << "'";
    kill(pid_, SIGKILL);
  }
  int status = 0;
  waitpid(std::exchange(pid_, -1), &status, 0);
  return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          .out = out_text_,
          .err = err_text_};
}

Ended run(const std::vector<std::string>& arguments) { return Process(arguments).wait(); }

bool await(const std::function<bool()>& condition) {
  const auto end = steady_clock::now() + kPatience;
  while (!condition()) {
    if (steady_clock::now() > end) return false;
    poll(nullptr, 0, 1);
  }
  return true;
}

nlohmann::json info(const std::string& stream) {
  const Ended ended = run({"info", stream, "--json"});
  return ended.code == 0 ? nlohmann::json::parse(ended.out) : nlohmann::json();
}

TestStream::TestStream() : name_(unique_name("test.")) {}

TestStream::~TestStream() {
  try {
    ipc::remove_stream(name_);
  } catch (const ipc::NoSuchStream&) {
    return;  // nothing is left
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
}

TestFolder::TestFolder()
    : path_((std::filesystem::temp_directory_path() / unique_name("splinecast.")).string()) {
  std::filesystem::create_directories(path_);
}

TestFolder::~TestFolder() { std::filesystem::remove_all(path_); }

std::string TestFolder::write(const std::string& file, const std::string& text) const {
  std::ofstream(path(file)) << text;
  return path(file);
}

std::string read_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

}  // namespace splinecast::testing
