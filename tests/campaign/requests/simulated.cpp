#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "apps/process/shared_log.hpp"
#include "apps/process/signals.hpp"
#include "ipc/law/commander_record.hpp"
#include "ipc/law/law_board.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/request.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/kills/journal.hpp"

/// Random requests of a time law in simulated time: one process, real regions.
namespace splinecast::campaign {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// The rate of a law is read from a position in seconds since its origin.
constexpr double kNoise = 1e-6;

/// A clock that advances at each reading, sometimes by as much as a process is stopped. A child
/// process advances the same time.
class JumpyClock final : public Clock {
 public:
  explicit JumpyClock(std::mt19937_64& random) : random_(random) { *time = MonotonicClock().now(); }
  [[nodiscard]] Time now() const noexcept override {
    constexpr std::int64_t kRare = 200;
    const bool jumps = is_jumpy && below(kRare) == 0;
    *time += jumps ? Time(below(60'000'000)) : Time(below(20'000));
    return *time;
  }
  apps::Shared<Time> time;
  bool is_jumpy = true;

 private:
  [[nodiscard]] std::int64_t below(std::int64_t end) const noexcept {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }
  std::mt19937_64& random_;
};

/// A commander's region, in which this process writes requests at simulated times.
struct SimulatedCommander {
  ipc::OwnerLock lock;
  ipc::OwnedRequest own;
  ipc::RateCommand command;

  explicit SimulatedCommander(const std::string& name)
      : lock(name, ipc::RegionKind::commander),
        own(ipc::own_request(name, ipc::RegionKind::commander, {}, {}, lock)) {
    lock.keep_file();
  }
  /// The requested rate at the end of all ramps and dead men; below 0: none.
  [[nodiscard]] double final_rate() const noexcept {
    const bool dies = command.rate > 0 && command.dead_man > Time::zero();
    return dies ? 0 : command.rate;
  }
};

struct SimulatedFacts {
  std::uint64_t lost = 0;
  std::uint64_t exceeded = 0;
  std::uint64_t wrong_rate = 0;
  std::uint64_t raised = 0;   ///< bounds that a request has raised above what it and they were
  std::uint64_t renewed = 0;  ///< bounds that a renewal has changed
  std::uint64_t renewals = 0;
  std::uint64_t samples = 0;
  std::uint64_t takeovers = 0;
  std::uint64_t kills = 0;
  std::uint64_t missed = 0;
  std::uint64_t rests = 0;
  double largest_excess = 0;
};

/// The highest rate of a bound from `now` on: each of its pieces is monotone.
double highest(const core::RateCurve& bound, Time now) noexcept {
  double rate = std::max(bound.at(now).rate, bound.last_rate());
  for (const core::RatePiece& piece : bound.pieces()) {
    if (piece.end() > now) rate = std::max(rate, piece.end_rate);
  }
  return rate;
}

class SimulatedLaw {
 public:
  SimulatedLaw(std::string law, std::uint64_t seed)
      : law_(std::move(law)), random_(seed), clock_(random_), board_(law_, {}) {
    for (int i = 0; i < kCommanders; ++i) {
      commanders_.push_back(std::make_unique<SimulatedCommander>(
          ipc::commander_stream(law_, std::string(1, static_cast<char>('a' + i)))));
    }
    start_solver();
    while (!board_.is_there()) step();
    reader_.emplace(law_);
  }
  SimulatedLaw(const SimulatedLaw&) = delete;
  SimulatedLaw& operator=(const SimulatedLaw&) = delete;
  ~SimulatedLaw() {
    reader_.reset();
    solver_.reset();
    commanders_.clear();
    try {
      remove_stream(law_);
    } catch (const StreamError&) {
      return;
    }
  }

  /// One request, until it is in force; sometimes a renewal before it, or the way to rest after it.
  void play() {
    SimulatedCommander& commander = *commanders_[static_cast<std::size_t>(below(kCommanders))];
    if (below(3) == 0) renew(commander);
    const auto before = board_.commander(commander.own.id);
    give(commander);
    constexpr int kMostSteps = 100;
    int steps = 0;
    for (; steps < kMostSteps && !is_in_force(commander); ++steps) step();
    if (steps == kMostSteps) ++facts_.lost;
    if (before) compare(*before, commander);
    for (auto more = below(30); more > 0; --more) step();
    if (below(25) == 0) come_to_rest();
  }

  [[nodiscard]] const SimulatedFacts& facts() const noexcept { return facts_; }

 private:
  static constexpr int kCommanders = 4;

  [[nodiscard]] std::int64_t below(std::int64_t end) {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }
  /// From 1 ms to 1 s, as often between 1 and 10 ms as between 100 ms and 1 s.
  [[nodiscard]] Time ramp() {
    const double exponent = std::uniform_real_distribution(0.0, 3.0)(random_);
    return Time(static_cast<std::int64_t>(1e6 * std::pow(10.0, exponent)));
  }

  void give(SimulatedCommander& commander) {
    ipc::RateCommand& command = commander.command;
    ++command.number;
    command.time = clock_.now();
    command.ramp = ramp();
    command.dead_man = Time::zero();
    switch (below(6)) {
      case 0:
      case 1:
        command.rate = 0;
        break;
      case 2:
        command.rate = -1;
        break;
      case 3:
        command.dead_man = milliseconds(1 + below(50));
        command.dead_man_ramp = ramp();
        [[fallthrough]];
      default:
        command.rate = static_cast<double>(1 + below(100)) / 100;
    }
    ipc::write_command(commander.own.control, command);
  }

  /// A renewal changes no bound. A dead man would.
  void renew(SimulatedCommander& commander) {
    const auto before = board_.commander(commander.own.id);
    if (!before || commander.command.dead_man > Time::zero()) return;
    commander.command.time = clock_.now();
    ipc::write_command(commander.own.control, commander.command);
    ++facts_.renewals;
    for (int steps = 0; steps < 3; ++steps) step();
    const auto after = board_.commander(commander.own.id);
    if (after && after->bound.begin() != before->bound.begin()) ++facts_.renewed;
  }

  /// A request in force has not raised the commander's bound above what it is for.
  void compare(const ipc::CommanderEntry& before, const SimulatedCommander& commander) {
    const ipc::RateCommand& command = commander.command;
    const auto after = board_.commander(commander.own.id);
    if (!after || command.rate < 0) return;
    const double most = std::max(highest(before.bound, command.time), command.rate);
    if (highest(after->bound, after->bound.begin()) > most + kNoise) ++facts_.raised;
  }

  [[nodiscard]] bool is_in_force(const SimulatedCommander& commander) {
    const auto entry = board_.commander(commander.own.id);
    return entry && entry->number >= commander.command.number;
  }

  void start_solver() {
    solver_.reset();
    solver_.emplace(law_, SolverOptions{});
    while (!solver_->attach(clock_)) *clock_.time += milliseconds(1);
  }

  /// A process takes over, and dies before one of its stores.
  void die_in_a_step() {
    constexpr int kMostStores = 400;
    const auto store = static_cast<std::uint64_t>(1 + below(kMostStores));
    solver_.reset();
    const pid_t child = fork();
    if (child == 0) {
      kill_before_store(store);
      start_solver();
      for (int steps = 0; steps < 4; ++steps) {
        *clock_.time += microseconds(below(3000));
        (void)solver_->step(clock_);
      }
      _exit(0);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) throw apps::Failure("cannot fork");
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
      ++facts_.kills;
    } else if (status != 0) {
      throw apps::Failure("a solver that takes over ends with status " + std::to_string(status));
    }
  }

  void step() {
    *clock_.time += microseconds(below(3000));
    if (clock_.is_jumpy && below(100) == 0) {
      ++facts_.takeovers;
      if (has_hooks()) die_in_a_step();
      start_solver();
    }
    if (solver_->step(clock_).missed) ++facts_.missed;
    if (reader_) check();
  }

  /// Compares the law's rate with the bounds.
  void check() {
    State state(1);
    const Time now = *clock_.time;
    if (!has_values(reader_->preview(now, state))) return;
    ++facts_.samples;
    for (const ipc::CommanderEntry& commander : board_.commanders()) {
      // A bound that begins later does not say what it was before.
      if (commander.bound.begin() > now) continue;
      const double excess = state.velocity()[0] - commander.bound.at(now).rate;
      facts_.largest_excess = std::max(facts_.largest_excess, excess);
      if (excess > kNoise) ++facts_.exceeded;
    }
  }

  /// Lets all ramps and dead men end, without disturbance: then the law has the least rate.
  void come_to_rest() {
    clock_.is_jumpy = false;
    for (const Time end = *clock_.time + std::chrono::seconds(12); *clock_.time < end;) {
      *clock_.time += milliseconds(10);
      step();
    }
    clock_.is_jumpy = true;
    double least = 2;
    for (const auto& commander : commanders_) {
      const double rate = commander->final_rate();
      if (rate >= 0) least = std::min(least, rate);
    }
    State state(1);
    const bool has_rate = has_values(reader_->preview(*clock_.time, state));
    ++facts_.rests;
    const double expected = least > 1 ? 1 : least;
    if (!has_rate || std::abs(state.velocity()[0] - expected) > kNoise) ++facts_.wrong_rate;
  }

  std::string law_;
  std::mt19937_64 random_;
  JumpyClock clock_;
  std::vector<std::unique_ptr<SimulatedCommander>> commanders_;
  std::optional<Solver> solver_;
  std::optional<Reader> reader_;
  ipc::LawBoard board_;
  SimulatedFacts facts_;
};

}  // namespace

Result run_simulated_requests(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  SimulatedLaw law(campaign_stream("requests"), options.seed);
  for (std::uint64_t i = 0; i < options.runs && !apps::stop_requested(); ++i) law.play();
  const SimulatedFacts& facts = law.facts();
  return make_result(
      options, {5, 8},
      "simulated requests: random requests of the rate by 4 commanders, with a clock "
      "that advances within each step and jumps by up to 60 ms, and takeovers, also from solvers "
      "that are killed before any of their stores",
      options.runs, "requests",
      {{"requests lost", facts.lost},
       {"samples above a bound", facts.exceeded},
       {"bounds that a request has raised above what it asks", facts.raised},
       {"bounds that a renewal has changed", facts.renewed},
       {"rests at another than the least rate", facts.wrong_rate}},
      {{"samples compared with the bounds", facts.samples},
       {"solvers killed before one of their stores", facts.kills},
       {"largest excess", facts.largest_excess},
       {"rests compared with the least rate", facts.rests},
       {"renewals", facts.renewals},
       {"takeovers", facts.takeovers},
       {"revisions discarded because they were too late", facts.missed}},
      to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
