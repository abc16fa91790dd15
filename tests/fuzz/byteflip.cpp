#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <span>

#include "apps/output/stream.hpp"
#include "apps/process/messages.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "tests/fixtures/processes/patience.hpp"
#include "tests/fuzz/byteflip_roles.hpp"

/// Flips random bytes in both regions of live streams, while the processes of a producer, a solver
/// and two readers use them. No process may crash, hang, or return a value that is not finite; a
/// process may refuse a damaged region. Exit code 3 if a promise was broken.
namespace splinecast::fuzz {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr std::array kKinds{ipc::RegionKind::waypoints, ipc::RegionKind::spline};
/// Timeout of a process for its end after `stop`, on a busy machine.
using testing::kPatience;

/// A writable mapping of a region's file that never changes its length.
class Victim {
 public:
  Victim(const std::string& stream, ipc::RegionKind kind) {
    const int file = open(ipc::region_path(stream, kind).c_str(), O_RDWR | O_CLOEXEC);
    struct stat status {};
    if (file >= 0 && fstat(file, &status) == 0 && status.st_size > 0) {
      const auto size = static_cast<std::size_t>(status.st_size);
      void* const at = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      if (at != MAP_FAILED) bytes_ = {static_cast<std::uint8_t*>(at), size};  // NOLINT(*-cast)
    }
    if (file >= 0) close(file);
  }
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;
  ~Victim() {
    if (!bytes_.empty()) munmap(bytes_.data(), bytes_.size());
  }
  [[nodiscard]] bool is_there() const { return !bytes_.empty(); }

  /// Flips one bit, or random bits, of a byte in the header, in the control block or anywhere.
  void flip(std::mt19937_64& random) {
    const std::size_t limit = random() % 4 == 0 ? ipc::kBodyOffset : bytes_.size();
    const std::size_t at = random() % std::min(limit, bytes_.size());
    const auto bits = static_cast<std::uint8_t>(random() % 2 == 0 ? 1U << random() % 8 : random());
    std::atomic_ref(bytes_[at]).fetch_xor(bits, std::memory_order_relaxed);
  }

 private:
  std::span<std::uint8_t> bytes_;
};

/// Memory that forked processes share.
FlipCounters& shared_counters() {
  void* const at = mmap(nullptr, sizeof(FlipCounters), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) throw std::runtime_error("no shared memory");  // NOLINT(*-cast)
  return *new (at) FlipCounters{};
}

class Campaign {
 public:
  explicit Campaign(std::uint64_t seed)
      : random_(seed),
        counters_(shared_counters()),
        name_("test." + std::to_string(getpid()) + ".byteflip") {}

  void run_for(steady_clock::duration time) {
    const auto end = steady_clock::now() + time;
    while (steady_clock::now() < end) round();
  }

  [[nodiscard]] bool is_sound() const {
    return crashes_ + hangs_ + failures_ + counters_.not_numbers.load() == 0;
  }

  [[nodiscard]] nlohmann::ordered_json report() const {
    return {{"count", flips_},
            {"unit", "flipped bytes"},
            {"found",
             {{"crashes", crashes_},
              {"hangs", hangs_},
              {"undocumented exceptions", failures_},
              {"values with NaN or infinity", counters_.not_numbers.load()}}},
            {"measured",
             {{"streams", rounds_},
              {"samples", counters_.samples.load()},
              {"samples with values", counters_.with_values.load()},
              {"snapshots", counters_.snapshots.load()},
              {"readers attached", counters_.attached.load()},
              {"readers refused", counters_.refused.load()},
              {"runs of info", counters_.reports.load()},
              {"waypoints appended", counters_.appended.load()},
              {"revisions", counters_.revisions.load()},
              {"solvers that refused", refused_["solver"]},
              {"producers that refused", refused_["producer"]}}}};
  }

 private:
  struct Child {
    const char* role;
    pid_t pid;
  };

  /// Attacks one stream until a process ends, or for a fraction of a second.
  void round() {
    ++rounds_;
    counters_.stop = false;
    std::vector<Child> children;
    children.push_back(
        start("producer", [this] { return produce_until_stopped(name_, counters_); }));
    children.push_back(start("solver", [this] { return solve_until_stopped(name_, counters_); }));
    for (int i = 0; i < 2; ++i) {
      const std::uint64_t seed = random_();
      children.push_back(
          start("reader", [this, seed] { return read_until_stopped(name_, seed, counters_); }));
    }
    attack(children);
    counters_.stop = true;
    for (const Child& child : children) end(child);
    for (const auto kind : kKinds) {
      ipc::unlink_region(name_, kind);
      unlink(ipc::lock_path(name_, kind).c_str());
    }
  }

  Child start(const char* role, const std::function<bool()>& work) {
    const pid_t pid = fork();
    if (pid < 0) throw std::runtime_error("no process for a role");
    if (pid > 0) return {role, pid};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    int code = kFailed;
    try {
      code = work() ? kLeft : kRefused;
    } catch (const std::exception& error) {
      apps::say(error.what());
    }
    _exit(code);
  }

  /// Waits for both regions, then flips a few bytes each millisecond.
  void attack(const std::vector<Child>& children) {
    constexpr auto kRound = 150ms;
    const auto deadline = steady_clock::now() + kPatience;
    std::array<std::optional<Victim>, 2> victims;
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
      while (steady_clock::now() < deadline && !(victims[i] && victims[i]->is_there())) {
        poll(nullptr, 0, 1);
        victims[i].emplace(name_, kKinds[i]);
      }
      if (!victims[i]->is_there()) throw std::runtime_error("no stream was created");
    }
    const std::uint64_t until = counters_.samples + 100;  // so that readers are sampling
    while (counters_.samples < until && steady_clock::now() < deadline) poll(nullptr, 0, 1);
    const auto end = steady_clock::now() + kRound;
    const std::size_t most = std::size_t{1} << random_() % 6;
    while (steady_clock::now() < end && all_live(children)) {
      for (std::size_t count = 1 + random_() % most; count > 0; --count) {
        victims[random_() % 2]->flip(random_);
        ++flips_;
      }
      poll(nullptr, 0, 1);
    }
  }

  static bool all_live(const std::vector<Child>& children) {
    return std::ranges::all_of(children, [](const Child& child) {
      siginfo_t info{};
      waitid(P_PID, static_cast<id_t>(child.pid), &info, WEXITED | WNOHANG | WNOWAIT);
      return info.si_pid == 0;
    });
  }

  /// Waits for a child's end and counts it by its kind.
  void end(const Child& child) {
    const auto deadline = steady_clock::now() + kPatience;
    int status = 0;
    while (waitpid(child.pid, &status, WNOHANG) == 0) {
      if (steady_clock::now() > deadline) {
        ++hangs_;
        apps::say(std::string(child.role) + " hangs");
        kill(child.pid, SIGKILL);
        waitpid(child.pid, &status, 0);
        return;
      }
      poll(nullptr, 0, 1);
    }
    if (WIFSIGNALED(status)) {
      ++crashes_;
      apps::say(std::string(child.role) + " ended by signal " + std::to_string(WTERMSIG(status)));
    } else if (WEXITSTATUS(status) == kRefused) {
      ++refused_[child.role];
    } else if (WEXITSTATUS(status) != kLeft) {
      ++failures_;
    }
  }

  static constexpr int kLeft = 0;
  static constexpr int kFailed = 1;
  static constexpr int kRefused = 3;

  std::mt19937_64 random_;
  FlipCounters& counters_;
  std::string name_;
  std::uint64_t flips_ = 0;
  std::uint64_t rounds_ = 0;
  std::uint64_t crashes_ = 0;
  std::uint64_t hangs_ = 0;
  std::uint64_t failures_ = 0;
  mutable std::map<std::string, std::uint64_t> refused_;
};

}  // namespace
}  // namespace splinecast::fuzz

int main(int argc, char** argv) {
  CLI::App program("Flips bytes in the regions of live streams", "splinecast_byteflip");
  double seconds = 3;
  std::uint64_t seed = 1;
  program.add_option("--seconds", seconds, "Duration (default 3)");
  program.add_option("--seed", seed, "Seed of the random flips (default 1)");
  try {
    program.parse(argc, argv);
    splinecast::fuzz::Campaign campaign(seed);
    campaign.run_for(std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000)));
    splinecast::apps::print_report(campaign.report().dump(2) + "\n");
    return campaign.is_sound() ? 0 : 3;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    splinecast::apps::say(error.what());
    return 1;
  }
}
