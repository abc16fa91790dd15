#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <list>
#include <memory>
#include <new>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/stopper.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/requests/roles.hpp"
#include "tests/campaign/requests/stops.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kCommanders = 16;
constexpr std::size_t kStoppers = 6;
constexpr int kOtherFiles = 5000;

/// Other files in the folder of shared memory, which a solver that looks for commanders reads.
class OtherFiles {
 public:
  explicit OtherFiles(const std::string& prefix) : prefix_(fmt::format("/{}.other.", prefix)) {
    for (int i = 0; i < kOtherFiles; ++i) {
      const int file = shm_open(fmt::format("{}{}", prefix_, i).c_str(), O_CREAT | O_RDWR, 0600);
      if (file < 0) throw apps::Failure("cannot create files in the folder of shared memory");
      close(file);
    }
  }
  OtherFiles(const OtherFiles&) = delete;
  OtherFiles& operator=(const OtherFiles&) = delete;
  ~OtherFiles() {
    for (int i = 0; i < kOtherFiles; ++i) shm_unlink(fmt::format("{}{}", prefix_, i).c_str());
  }

 private:
  std::string prefix_;
};

/// Facts in memory that this process shares with its children.
class SharedFacts {
 public:
  SharedFacts()
      : memory_(mmap(nullptr, sizeof(RequestFacts), PROT_READ | PROT_WRITE,
                     MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw apps::Failure("no memory");
    facts_ = new (memory_) RequestFacts{};
  }
  SharedFacts(const SharedFacts&) = delete;
  SharedFacts& operator=(const SharedFacts&) = delete;
  ~SharedFacts() { munmap(memory_, sizeof(RequestFacts)); }
  RequestFacts& operator*() const noexcept { return *facts_; }
  RequestFacts* operator->() const noexcept { return facts_; }

 private:
  void* memory_;
  RequestFacts* facts_;
};

/// A law with its solver and its commanders, and a stream with its producer, its solver and its
/// stoppers, which this disturbs.
class AttackedLaw {
 public:
  AttackedLaw(std::string law, std::uint64_t seed)
      : law_(std::move(law)),
        stream_(law_ + ".arm"),
        random_(seed),
        commanders_(kCommanders),
        stoppers_(kStoppers) {
    start_solver(law_, solver_);
    start_solver(stream_, stream_solver_);
    start_producer();
    for (std::size_t i = 0; i < kCommanders; ++i) start_commander(i);
    for (std::size_t i = 0; i < kStoppers; ++i) start_stopper(i);
    check_.emplace([this] {
      run_bound_check(law_, *facts_);
      return nullptr;
    });
    const unsigned cpus = std::max(std::thread::hardware_concurrency(), 1U);
    for (unsigned i = 0; i < cpus; ++i) {
      busy_.push_back(std::make_unique<apps::Child>([] {
        run_busy();
        return nullptr;
      }));
    }
  }
  AttackedLaw(const AttackedLaw&) = delete;
  AttackedLaw& operator=(const AttackedLaw&) = delete;
  ~AttackedLaw() {
    check_.reset();
    commanders_.clear();
    stoppers_.clear();
    producer_.reset();
    solver_.reset();
    stream_solver_.reset();
    busy_.clear();
    for (const std::string& stream : {law_, stream_}) {
      try {
        remove_stream(stream);
      } catch (const StreamError&) {
        continue;  // it has not begun
      }
    }
  }

  /// Kills or stops a process, and starts it again.
  void disturb() {
    reap();
    const std::int64_t what = below(10);
    const bool is_of_law = below(2) == 0;
    std::optional<apps::Child>& solver = is_of_law ? solver_ : stream_solver_;
    if (what < 3) {
      // The next one waits for its lock only: a killed process can take long to end.
      solver->signal(SIGKILL);
      dying_.push_back(std::move(*solver));
      ++facts_->solvers_killed;
      start_solver(is_of_law ? law_ : stream_, solver);
    } else if (what < 6) {
      solver->signal(SIGSTOP);
      std::this_thread::sleep_for(milliseconds(1 + below(300)));
      solver->signal(SIGCONT);
      ++facts_->solvers_stopped;
    } else if (what < 8) {
      const auto i = static_cast<std::size_t>(below(kCommanders));
      commanders_[i].reset();
      ++facts_->commanders_killed;
      start_commander(i);
    } else {
      const auto i = static_cast<std::size_t>(below(kStoppers));
      stoppers_[i].reset();
      ++facts_->stoppers_killed;
      start_stopper(i);
      if (below(4) == 0) start_producer();
    }
    std::this_thread::sleep_for(milliseconds(below(150)));
  }

  /// Ends the commanders; then releases all requests, and checks that the law returns to rate 1.
  void finish() {
    reap();
    commanders_.clear();
    stoppers_.clear();
    check_.reset();
    busy_.clear();
    release_all();
    std::uint64_t lost = 0;
    for (std::size_t i = 0; i < kCommanders; ++i) {
      RateCommander commander(law_, name(i));
      const std::uint64_t number = commander.release(milliseconds(10));
      if (!commander.wait_in_force(number, std::chrono::minutes(1))) ++lost;
    }
    facts_->lost += lost;
    Reader reader(law_);
    State state(1);
    const MonotonicClock clock;
    const auto is_at_one = [&] {
      return has_values(reader.sample(clock.now(), state)) &&
             std::abs(state.velocity()[0] - 1) < 1e-6;
    };
    for (const Time end = clock.now() + std::chrono::minutes(1); !is_at_one();) {
      if (clock.now() > end) {
        ++facts_->lost;
        break;
      }
      std::this_thread::sleep_for(milliseconds(1));
    }
  }

  [[nodiscard]] const RequestFacts& facts() const noexcept { return *facts_; }

 private:
  [[nodiscard]] std::int64_t below(std::int64_t end) {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }
  [[nodiscard]] static std::string name(std::size_t i) { return fmt::format("c{}", i); }

  static void start_solver(const std::string& stream, std::optional<apps::Child>& solver) {
    solver.emplace([stream] {
      run_solver_of(stream);
      return nullptr;
    });
  }
  void start_producer() {
    const std::uint64_t seed = random_();
    producer_.emplace([this, seed] {
      run_stopped_producer(stream_, seed, *facts_);
      return nullptr;
    });
  }
  void start_stopper(std::size_t i) {
    const std::uint64_t seed = random_();
    stoppers_[i] = std::make_unique<apps::Child>([this, i, seed] {
      run_stopper(stream_, name(i), seed, *facts_);
      return nullptr;
    });
  }
  /// Releases the stops that are left, and checks that the stream moves again.
  void release_all() {
    for (std::size_t i = 0; i < kStoppers; ++i) {
      Stopper stopper(stream_, name(i));
      if (!stopper.wait_in_force(stopper.release(), std::chrono::minutes(1))) {
        ++facts_->lost_stops;
      }
    }
    const MonotonicClock clock;
    const Time end = clock.now() + std::chrono::minutes(1);
    for (bool moves = false; !moves; std::this_thread::sleep_for(milliseconds(1))) {
      moves = is_moving();
      if (!moves && clock.now() > end) {
        ++facts_->lost_stops;
        return;
      }
    }
  }
  [[nodiscard]] bool is_moving() const {
    try {
      Reader reader(stream_);
      State state(reader.dimensions());
      return has_values(reader.sample(MonotonicClock().now(), state)) && state.velocity()[0] != 0;
    } catch (const StreamError&) {
      return false;
    }
  }
  void start_commander(std::size_t i) {
    const std::uint64_t seed = random_();
    commanders_[i] = std::make_unique<apps::Child>([this, i, seed] {
      run_commander(law_, name(i), seed, *facts_);
      return nullptr;
    });
  }
  /// Counts processes that have ended by themselves, and starts them again.
  void reap() {
    std::erase_if(dying_, [](apps::Child& child) { return child.ended().has_value(); });
    for (const bool is_of_law : {true, false}) {
      std::optional<apps::Child>& solver = is_of_law ? solver_ : stream_solver_;
      if (!solver->ended()) continue;
      ++facts_->failed;
      solver.reset();
      start_solver(is_of_law ? law_ : stream_, solver);
    }
    if (producer_->ended()) {
      ++facts_->failed;
      start_producer();
    }
    for (std::size_t i = 0; i < kStoppers; ++i) {
      if (!stoppers_[i]->ended()) continue;
      ++facts_->failed;
      start_stopper(i);
    }
    for (std::size_t i = 0; i < kCommanders; ++i) {
      if (!commanders_[i]->ended()) continue;
      ++facts_->failed;
      start_commander(i);
    }
  }

  std::string law_;
  std::string stream_;
  SharedFacts facts_;
  std::mt19937_64 random_;
  std::optional<apps::Child> solver_;
  std::optional<apps::Child> stream_solver_;
  std::optional<apps::Child> producer_;
  std::vector<std::unique_ptr<apps::Child>> commanders_;
  std::vector<std::unique_ptr<apps::Child>> stoppers_;
  std::list<apps::Child> dying_;  ///< solvers that were killed
  std::optional<apps::Child> check_;
  std::vector<std::unique_ptr<apps::Child>> busy_;
};

}  // namespace

Result run_requests(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  const std::string law = campaign_stream("requests");
  const OtherFiles others(law);
  AttackedLaw attacked(law, options.seed);
  const Time end = clock.now() + from_seconds(options.seconds);
  while (clock.now() < end && !apps::stop_requested()) attacked.disturb();
  attacked.finish();
  return make_result(
      options, {5, 8},
      "requests: 16 commander processes make random requests of a time law, among them holds and "
      "dead men, and 6 stopper processes hold and release a stream, which its producer sometimes "
      "creates again, beside a busy loop on every CPU and 5,000 other files, while solvers are "
      "killed and stopped, and commanders, stoppers and the producer are killed",
      attacked.facts().requests(), "requests", attacked.facts().found(),
      attacked.facts().measured(), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
