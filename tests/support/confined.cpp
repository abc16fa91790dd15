#include "support/confined.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "support/allocations.hpp"
#include "support/process.hpp"

namespace splinecast::testing {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

/// Lets only `exit_group` and `write` pass.
bool forbid_system_calls() {
  constexpr std::uint16_t kLoad = BPF_LD | BPF_W | BPF_ABS;
  constexpr std::uint16_t kJumpIfEqual = BPF_JMP | BPF_JEQ | BPF_K;
  constexpr std::uint16_t kReturn = BPF_RET | BPF_K;
  std::array<sock_filter, 7> filter{{
      {kLoad, 0, 0, offsetof(seccomp_data, arch)},
      {kJumpIfEqual, 0, 3, kArchitecture},
      {kLoad, 0, 0, offsetof(seccomp_data, nr)},
      {kJumpIfEqual, 2, 0, SYS_exit_group},
      {kJumpIfEqual, 1, 0, SYS_write},
      {kReturn, 0, 0, SECCOMP_RET_KILL_PROCESS},
      {kReturn, 0, 0, SECCOMP_RET_ALLOW},
  }};
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()),
                           .filter = filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

struct Faults {
  std::uint64_t minor = 0, major = 0;
};

/// The page faults of a process so far: fields 10 and 12 of its `stat`.
Faults faults_of(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  stat.ignore(std::numeric_limits<std::streamsize>::max(), ')');
  std::string skipped;
  for (int field = 3; field < 10; ++field) stat >> skipped;
  Faults faults;
  stat >> faults.minor >> skipped >> faults.major;
  if (!stat) throw std::runtime_error("no page faults of process " + std::to_string(pid));
  return faults;
}

void await_phase(const std::atomic<int>& phase, int wanted) {
  while (phase.load() != wanted) {
  }
}

/// A page that parent and child share.
class SharedPage {
 public:
  SharedPage()
      : memory_(mmap(nullptr, sizeof(ConfinedPage), PROT_READ | PROT_WRITE,
                     MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::runtime_error("no shared page");
    page_ = new (memory_) ConfinedPage{};
  }
  SharedPage(const SharedPage&) = delete;
  SharedPage& operator=(const SharedPage&) = delete;
  ~SharedPage() { munmap(memory_, sizeof(ConfinedPage)); }
  ConfinedPage& operator*() { return *page_; }

 private:
  void* memory_;
  ConfinedPage* page_;
};

}  // namespace

void Confined::confine() {
  if (!forbid_system_calls()) _exit(1);
  allocations_ = allocations();
  page_->phase = ConfinedPage::confined;
  await_phase(page_->phase, ConfinedPage::running);
}

void Confined::finish() {
  page_->allocations = allocations() - allocations_;
  page_->phase = ConfinedPage::done;
  await_phase(page_->phase, ConfinedPage::released);
  _exit(0);
}

ConfinedEnd run_confined(const std::function<void(Confined&)>& inside,
                         const std::function<void()>& meanwhile) {
  SharedPage shared;
  ConfinedPage& page = *shared;
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("no process");
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    Confined child(page);
    try {
      inside(child);
    } catch (...) {
      _exit(2);
    }
    _exit(3);  // it never finished
  }
  Faults before;
  Faults after;
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (page.phase == ConfinedPage::confined) {
      before = faults_of(pid);
      page.phase = ConfinedPage::running;
    } else if (page.phase == ConfinedPage::done) {
      after = faults_of(pid);
      page.phase = ConfinedPage::released;
    }
    if (meanwhile) meanwhile();
    if (std::chrono::steady_clock::now() > end) kill(pid, SIGKILL);
  }
  return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          .allocations = page.allocations,
          .minor_faults = after.minor - before.minor,
          .major_faults = after.major - before.major,
          .rounds = page.rounds,
          .answered = page.answered,
          .busy = page.busy,
          .midway = page.midway,
          .overtaken = page.overtaken,
          .cpu_ns = page.cpu_ns};
}

}  // namespace splinecast::testing
