#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/interprocess/anonymous_shared_memory.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/stoppers.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/stopper.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/kills/journal.hpp"
#include "tests/campaign/kills/roles.hpp"
#include "tests/campaign/requests/stops.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kName = "anna";
/// Steps of the solver after a request, within which it commits that.
constexpr int kSteps = 4;
/// After this many processes that end before store n, no process does a store n.
constexpr int kSurvivals = 3;
/// More stores than any of these steps does.
constexpr std::uint64_t kMostStores = 500;

/// Memory that the attacking process shares with those that it kills.
struct Orders {
  std::atomic<bool> pauses;          ///< the solver must do no step
  std::atomic<bool> is_paused;       ///< it does none
  std::atomic<std::uint64_t> store;  ///< of its next steps, before which the solver dies; 0: none
  std::atomic<bool> has_survived;    ///< it has done these steps
  std::atomic<bool> has_returned;    ///< the call of the stopper that was to be killed has returned
};

/// Solves a stream; dies where it is ordered to.
void run_ordered_solver(const std::string& stream, Orders& orders) {
  const MonotonicClock clock;
  std::optional<Solver> solver = await_solver(stream, {});
  int steps = 0;
  while (!apps::stop_requested()) {
    orders.is_paused = orders.pauses.load();
    if (orders.is_paused && solver->attached()) {
      (void)apps::sleep_until(clock.now() + std::chrono::microseconds(200));
      continue;
    }
    if (!solver->attached()) (void)solver->attach();
    if (const std::uint64_t store = orders.store.exchange(0); store > 0) {
      kill_before_store(store);
      steps = kSteps;
    }
    const StepResult result = solver->step(clock);
    if (steps > 0 && --steps == 0) {
      kill_before_store(0);
      orders.has_survived = true;
    }
    if (result.consumed == 0 && !result.missed && steps == 0) solver->wait(milliseconds(5));
  }
}

/// A stream with a producer, a solver and a stopper, which are killed before their stores.
class StoppedStream {
 public:
  explicit StoppedStream(std::string stream)
      : stream_(std::move(stream)),
        memory_(boost::interprocess::anonymous_shared_memory(sizeof(Orders))),
        orders_(std::construct_at(static_cast<Orders*>(memory_.get_address()))),
        work_(boost::interprocess::anonymous_shared_memory(sizeof(RequestFacts))),
        facts_(std::construct_at(static_cast<RequestFacts*>(work_.get_address()))) {
    start_solver();
    producer_.emplace([this] {
      run_stopped_producer(stream_, 1, *facts_);
      return nullptr;
    });
    await("the motion", [this] { return is_moving(); });
  }
  StoppedStream(const StoppedStream&) = delete;
  StoppedStream& operator=(const StoppedStream&) = delete;
  ~StoppedStream() {
    producer_.reset();
    solver_.reset();
    try {
      remove_stream(stream_);
    } catch (const StreamError& error) {
      apps::say(error.what());
    }
  }

  /// Kills a process in this call of a stopper before each store in turn. Before each kill the
  /// request is `before`. Returns the number of stores.
  std::uint64_t stopper_in(bool before, const std::function<void(Stopper&)>& call, bool after) {
    return each_store([&](std::uint64_t store) {
      request(before);
      return stopper_dies(before, after, [&] {
        Stopper stopper(stream_, std::string(kName));
        kill_before_store(store);
        call(stopper);
        kill_before_store(0);
      });
    });
  }

  /// The same while a process becomes the stopper.
  std::uint64_t making_of_a_stopper() {
    return each_store([&](std::uint64_t store) {
      request(false);
      remove_request();
      return stopper_dies(false, false, [&] {
        kill_before_store(store);
        const Stopper stopper(stream_, std::string(kName));
        kill_before_store(0);
      });
    });
  }

  /// Kills the solver before each store of the steps in which it hears the request `after`.
  std::uint64_t solver_that_hears(bool after) {
    return each_store([&](std::uint64_t store) {
      request(!after);
      orders_->pauses = true;
      await("a pause of the solver", [this] { return orders_->is_paused.load(); });
      Stopper stopper(stream_, std::string(kName));
      const std::uint64_t number = after ? stopper.stop() : stopper.release();
      orders_->has_survived = false;
      orders_->store = store;
      orders_->pauses = false;
      bool died = false;
      await("the solver's steps", [&] {
        const auto code = solver_->ended();
        died = code.has_value();
        if (died && *code != -SIGKILL) ++failed_;
        return died || orders_->has_survived;
      });
      if (died) {
        ++kills_;
        orders_->store = 0;
        start_solver();
      }
      if (!stopper.wait_in_force(number, kLongestRequest)) ++lost_;
      compare(after);
      return died;
    });
  }

  /// Releases the stream, and checks that it moves again.
  void finish() {
    request(false);
    await("the motion", [this] { return is_moving(); });
  }

  [[nodiscard]] std::uint64_t kills() const noexcept { return kills_; }
  [[nodiscard]] nlohmann::json found() const {
    return {{"stops and releases lost", lost_},
            {"stoppers that another one could not follow", unusable_},
            {"holders on the board that differ from the requests", different_},
            {"samples that moved although a stopper held the stream", moved_},
            {"processes that failed", failed_}};
  }

 private:
  std::uint64_t each_store(const std::function<bool(std::uint64_t)>& dies_before) {
    for (std::uint64_t store = 1; store < kMostStores; ++store) {
      int survived = 0;
      while (survived < kSurvivals && !dies_before(store)) ++survived;
      if (survived == kSurvivals) return store - 1;
    }
    throw apps::Failure("a step has no last store");
  }

  void start_solver() {
    solver_.emplace([this] {
      run_ordered_solver(stream_, *orders_);
      return nullptr;
    });
  }

  /// Runs a process that may die, and checks the request that it leaves. Returns whether it died.
  bool stopper_dies(bool before, bool after, const std::function<void()>& run) {
    orders_->has_returned = false;
    apps::Child child([&] {
      run();
      orders_->has_returned = true;
      return nullptr;
    });
    std::optional<int> code;
    await("the end of a stopper", [&] { return (code = child.ended()).has_value(); });
    const bool died = *code == -SIGKILL;
    if (died) ++kills_;
    if (!died && *code != 0) ++failed_;
    check(before, after);
    return died;
  }

  /// Puts a stop or a release in force.
  void request(bool stops) {
    Stopper stopper(stream_, std::string(kName));
    const std::uint64_t number = stops ? stopper.stop() : stopper.release();
    if (!stopper.wait_in_force(number, kLongestRequest)) ++lost_;
  }

  /// Removes the region of a stopper that has released the stream.
  void remove_request() const {
    std::remove(
        ipc::region_path(ipc::stopper_stream(stream_, kName), ipc::RegionKind::stopper).c_str());
  }

  /// After the death of a stopper: its request is one of the two, the later one if the call has
  /// returned; the next stopper of its name and the solver agree on it.
  void check(bool before, bool after) {
    try {
      bool is_latched = false;
      {
        const Stopper next(stream_, std::string(kName));
        is_latched = next.is_latched();
      }
      const bool is_known = is_latched == after || (is_latched == before && !orders_->has_returned);
      // A record that is torn counts as a stop.
      if (!is_known && !is_latched) ++lost_;
      compare(is_latched);
    } catch (const StreamError& error) {
      ++unusable_;
      apps::say(error.what());
    }
  }

  /// Whether the board names the stopper exactly if it holds the stream, and the machine rests
  /// then.
  void compare(bool is_latched) {
    const Time end = clock_.now() + kLongestRequest;
    while (is_on_board() != is_latched) {
      if (!apps::sleep_until(clock_.now() + milliseconds(1)) || clock_.now() > end) {
        ++different_;
        return;
      }
    }
    if (!is_latched) return;
    (void)apps::sleep_until(clock_.now() + milliseconds(300));  // the curve stops within 0.26 s
    if (is_moving()) ++moved_;
  }

  [[nodiscard]] bool is_on_board() const {
    ipc::NamedBoard board(stream_, {});
    return board.is_there() && std::ranges::count(ipc::holders_of(board.reader()), kName) > 0;
  }

  [[nodiscard]] bool is_moving() const {
    try {
      Reader reader(stream_);
      State state(reader.dimensions());
      return has_values(reader.sample(clock_.now(), state)) && state.velocity()[0] != 0;
    } catch (const StreamError&) {
      return false;  // the stream is being created
    }
  }

  template <typename Condition>
  void await(const char* what, const Condition& condition) {
    const Time end = clock_.now() + kLongestRequest;
    while (!condition()) {
      if (clock_.now() > end || !apps::sleep_until(clock_.now() + std::chrono::microseconds(200))) {
        throw apps::Failure(fmt::format("'{}' waits in vain for {}", stream_, what));
      }
    }
  }

  std::string stream_;
  boost::interprocess::mapped_region memory_;
  Orders* orders_;
  boost::interprocess::mapped_region work_;
  RequestFacts* facts_;
  MonotonicClock clock_;
  std::optional<apps::Child> solver_;
  std::optional<apps::Child> producer_;
  std::uint64_t kills_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t unusable_ = 0;
  std::uint64_t different_ = 0;
  std::uint64_t moved_ = 0;
  std::uint64_t failed_ = 0;
};

}  // namespace

Result run_every_store_of_stops(const CampaignOptions& options) {
  if (!has_hooks()) throw apps::InputError("--every-store needs a build with SPLINECAST_HOOKS");
  const MonotonicClock clock;
  const Time begin = clock.now();
  StoppedStream stream(campaign_stream("stops"));
  const auto stop = [](Stopper& stopper) { stopper.stop(); };
  const auto release = [](Stopper& stopper) { stopper.release(); };
  nlohmann::json measured{
      {"stores of the making of a stopper", stream.making_of_a_stopper()},
      {"stores of a stop", stream.stopper_in(false, stop, true)},
      {"stores of a release", stream.stopper_in(true, release, false)},
      {"stores of a solver that hears a stop", stream.solver_that_hears(true)},
      {"stores of a solver that hears a release", stream.solver_that_hears(false)}};
  stream.finish();
  return make_result(options, {5, 8},
                     "kill at stores of a stop: SIGKILL before every store of a stopper that "
                     "is made, stops and releases, and of a solver that hears it",
                     stream.kills(), "kills", stream.found(), measured,
                     to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
