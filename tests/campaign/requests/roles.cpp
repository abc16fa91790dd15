#include "tests/campaign/kills/roles.hpp"
#include "tests/campaign/requests/roles.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>

#include "apps/process/signals.hpp"
#include "ipc/law/law_board.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

/// After this time a request is lost.

/// The rate of a law is read from a position in seconds since its origin.
constexpr double kRounding = 1e-6;

/// One commander.
class RandomCommander {
 public:
  RandomCommander(const std::string& law, const std::string& name, std::uint64_t seed,
                  RequestFacts& facts)
      : own_(law, name),
        board_(law, {}),
        law_(law, kLongestRequest),
        name_(name),
        facts_(facts),
        random_(seed) {}

  void act() {
    switch (below(8)) {
      case 0:
      case 1:
        return hold();
      case 2:
        return release();
      case 3:
        return let_die();
      case 4:
        return renew();
      default:
        return set_rate();
    }
  }

 private:
  [[nodiscard]] std::int64_t below(std::int64_t end) {
    return std::uniform_int_distribution<std::int64_t>(0, end - 1)(random_);
  }
  [[nodiscard]] Time ramp() { return milliseconds(1) + Time(below(150'000'000)); }
  [[nodiscard]] double rate() { return static_cast<double>(below(101)) / 100; }

  /// This commander as the board of the law has it.
  [[nodiscard]] std::optional<ipc::CommanderEntry> entry() {
    if (!board_.is_there()) return std::nullopt;
    const auto all = board_.commanders();
    const auto own = std::ranges::find(all, name_, &ipc::name_of);
    return own != all.end() ? std::optional(*own) : std::nullopt;
  }

  /// Waits until a request is in force. Returns its row; nothing if it is lost.
  std::optional<ipc::CommanderEntry> await(std::uint64_t number, Time made,
                                           RequestFacts::Count& count) {
    if (!own_.wait_in_force(number, kLongestRequest)) {
      if (!apps::stop_requested()) ++facts_.lost;
      return std::nullopt;
    }
    ++count;
    const auto own = entry();
    const bool is_own = own && own->number == number && !own->is_dead;
    if (is_own && own->bound.begin() > made) facts_.effects.note(own->bound.begin() - made);
    return own;
  }

  void set_rate() {
    const Time made = clock_.now();
    (void)await(own_.set_rate(rate(), ramp()), made, facts_.rates);
  }
  void release() {
    const Time made = clock_.now();
    (void)await(own_.release(ramp()), made, facts_.releases);
  }
  void hold() {
    const Time made = clock_.now();
    const auto own = await(own_.hold(ramp()), made, facts_.holds);
    if (!own) return;
    const Time end = own->bound.end() + Time(1);
    if (!apps::sleep_until(end)) return;
    State state(1);
    if (!has_values(law_.sample(end, state))) return;
    if (std::abs(state.velocity()[0]) > kRounding) ++facts_.not_held;
  }
  void let_die() {
    own_.set_dead_man(milliseconds(2 + below(30)), ramp());
    const Time made = clock_.now();
    const auto number = own_.set_rate(std::max(rate(), 0.01), ramp());
    own_.set_dead_man(Time::zero());
    if (!await(number, made, facts_.rates)) return;
    for (const Time end = clock_.now() + kLongestRequest; clock_.now() < end;) {
      const auto own = entry();
      if (own && own->is_dead && own->number == number) {
        ++facts_.dead_men;
        if (own_.renew()) ++facts_.revived;
        return;
      }
      if (!apps::sleep_until(clock_.now() + milliseconds(1))) return;
    }
    ++facts_.lost;
  }
  void renew() {
    (void)own_.renew();
    ++facts_.renewals;
  }

  RateCommander own_;
  ipc::LawBoard board_;
  Reader law_;
  std::string name_;
  RequestFacts& facts_;
  std::mt19937_64 random_;
  MonotonicClock clock_;
};

}  // namespace

void run_solver_of(const std::string& stream) {
  const MonotonicClock clock;
  std::optional<Solver> solver = await_solver(stream, {});
  while (!apps::stop_requested()) {
    if (!solver->attached()) (void)solver->attach();
    const StepResult result = solver->step(clock);
    if (result.consumed == 0 && !result.missed) solver->wait(milliseconds(50));
  }
}

void run_commander(const std::string& law, const std::string& name, std::uint64_t seed,
                   RequestFacts& facts) {
  const MonotonicClock clock;
  std::mt19937_64 random(seed + 1);
  RandomCommander commander(law, name, seed, facts);
  while (!apps::stop_requested()) {
    commander.act();
    const Time pause(std::uniform_int_distribution<std::int64_t>(0, 20'000'000)(random));
    (void)apps::sleep_until(clock.now() + pause);
  }
}

void run_bound_check(const std::string& law, RequestFacts& facts) {
  const MonotonicClock clock;
  Reader reader(law, kLongestRequest);
  ipc::LawBoard board(law, {});
  State state(1);
  while (apps::sleep_until(clock.now() + std::chrono::microseconds(200))) {
    const Time now = clock.now();
    const SampleStatus status = reader.sample(now, state);
    if (!has_values(status) || !board.is_there()) continue;
    ++facts.samples;
    const double rate = state.velocity()[0];
    const bool exceeds = std::ranges::any_of(board.commanders(), [&](const auto& commander) {
      // A bound that begins later does not say what it was before.
      return commander.bound.begin() <= now && rate > commander.bound.at(now).rate + kRounding;
    });
    if (exceeds) ++facts.exceeded;
  }
}

void run_busy() {
  while (!apps::stop_requested()) {
  }
}

}  // namespace splinecast::campaign
