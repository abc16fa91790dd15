#include "tests/campaign/record/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::campaign::record {
namespace {

constexpr mode_t kMode = 0600;
constexpr useconds_t kPause = 2000;

/// Replaces this process, a child, by the program.
[[noreturn]] void become(const std::string& files, const std::vector<char*>& arguments,
                         const std::vector<std::string>& environment) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);
  for (const auto& [extension, descriptor] : {std::pair(".out", 1), std::pair(".err", 2)}) {
    const int file = open((files + extension).c_str(), O_WRONLY | O_CREAT | O_TRUNC, kMode);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(apps::kFailed);
    close(file);
  }
  for (const std::string& variable : environment) putenv(const_cast<char*>(variable.c_str()));
  execv(SPLINECAST_PROGRAM, arguments.data());
  _exit(apps::kFailed);
}

}  // namespace

Folder::Folder() {
  std::string path = std::filesystem::temp_directory_path() / "splinecast.record.XXXXXX";
  if (mkdtemp(path.data()) == nullptr) throw apps::Failure("cannot create a folder");
  path_ = path;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> Folder::recordings() const {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) {
    if (entry.path().extension() == ".mcap") paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

Disk::Disk(std::string path) : path_(std::move(path)) {
  const int file = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  const bool is_sized = file >= 0 && ftruncate(file, sizeof(testing::DiskControl)) == 0;
  void* const memory = is_sized ? mmap(nullptr, sizeof(testing::DiskControl),
                                       PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                                : MAP_FAILED;
  if (file >= 0) close(file);
  if (memory == MAP_FAILED) throw apps::Failure(fmt::format("cannot create {}", path_));
  control_ = static_cast<testing::DiskControl*>(memory);
}

Disk::~Disk() { munmap(control_, sizeof(testing::DiskControl)); }

std::vector<std::string> Disk::environment() const {
  return {"LD_PRELOAD=" SPLINECAST_FAULTY_DISK_LIBRARY, "SPLINECAST_FAULTY_DISK=" + path_};
}

void Disk::fill(std::int64_t room) noexcept {
  control_->room = room;
  control_->is_full = 1;
}

void Disk::repair() noexcept {
  control_->is_full = 0;
  control_->rate = 0;
}

Program::Program(std::vector<std::string> arguments, std::string files,
                 std::vector<std::string> environment)
    : files_(std::move(files)) {
  arguments.insert(arguments.begin(), "splinecast");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw apps::Failure("cannot start the program");
  if (pid_ == 0) become(files_, pointers, environment);
}

Program::~Program() {
  if (code_ || pid_ < 0) return;
  signal(SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Program::signal(int number) const noexcept {
  if (!code_) kill(pid_, number);
}

bool Program::has_ended() {
  int status = 0;
  if (code_ || waitpid(pid_, &status, WNOHANG) != pid_) return code_.has_value();
  code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return true;
}

bool Program::await_message(const std::string& text) {
  const MonotonicClock clock;
  for (const Time end = clock.now() + kPatience; clock.now() < end; usleep(kPause)) {
    const bool is_last = has_ended();
    if (err().find(text) != std::string::npos) return true;
    if (is_last) return false;
  }
  return false;
}

std::optional<int> Program::wait() {
  const MonotonicClock clock;
  for (const Time end = clock.now() + kPatience; !has_ended() && clock.now() < end;) {
    usleep(kPause);
  }
  return code_;
}

std::size_t Program::memory() const {
  std::ifstream status(fmt::format("/proc/{}/status", pid_));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stoul(line.substr(line.find(':') + 1));
  }
  return 0;
}

std::string Program::read(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace splinecast::campaign::record
