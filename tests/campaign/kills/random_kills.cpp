#include <chrono>
#include <list>
#include <random>

#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/kills/attacked_stream.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::microseconds;

/// Number of waypoints of a recorded stream, which takes about 0.7 s.
constexpr ipc::Word kLife = 1400;
constexpr std::size_t kStreamsOfEachClock = 2;
/// Longest time from one kill on a stream to the next: kSoon for one in four, to kill processes
/// that have just started, else kLater.
constexpr Time kSoon = microseconds(6'000);
constexpr Time kLater = microseconds(80'000);
constexpr Time kRemoval = microseconds(3'000);

/// A stream and the time of its next kill.
class Victim {
 public:
  Victim(Plan plan, std::uint64_t seed) : stream_(std::move(plan)), random_(seed) {}

  /// Polls the stream, and kills a process when it is time.
  void tick(Time now) {
    stream_.tick();
    if (now < next_) return;
    next_ = now + up_to(random_() % 4 == 0 ? kSoon : kLater);
    const std::uint64_t draw = random_() % 20;
    if (draw < 8) {
      stream_.kill(Role::solver);
    } else if (draw < 15) {
      stream_.kill(Role::producer);
    } else if (draw < 19 || stream_.plan().is_live()) {
      stream_.kill(Role::reader, random_() % stream_.plan().readers);
    } else {
      stream_.kill_remover_at_end(up_to(kRemoval));
    }
  }

  [[nodiscard]] std::uint64_t kills() const { return stream_.findings().all_kills(); }
  Findings finish() { return stream_.finish(); }

 private:
  Time up_to(Time most) {
    return Time(std::uniform_int_distribution<std::int64_t>(0, most.count())(random_));
  }

  AttackedStream stream_;
  std::mt19937_64 random_;
  Time next_{};
};

}  // namespace

Result run_random_kills(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  std::list<Victim> victims;
  for (std::size_t i = 0; i < kStreamsOfEachClock; ++i) {
    const std::string number = std::to_string(i);
    victims.emplace_back(recorded_plan(campaign_stream("recorded" + number), kLife),
                         options.seed + 2 * i);
    victims.emplace_back(live_plan(campaign_stream("live" + number)), options.seed + 2 * i + 1);
  }
  const auto kills = [&] {
    std::uint64_t sum = 0;
    for (const Victim& victim : victims) sum += victim.kills();
    return sum;
  };
  while (kills() < options.kills && apps::sleep_until(clock.now() + kLook)) {
    for (Victim& victim : victims) victim.tick(clock.now());
  }
  Findings findings;
  for (Victim& victim : victims) findings.add(victim.finish());
  return make_result(
      options, {1, 2, 4, 5, 8},
      "random kills: SIGKILL at random instants of producers, solvers, readers and rm of two live "
      "and two recorded streams, also while they start, take over and remove",
      findings.all_kills(), "kills", findings, findings.killing(), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
