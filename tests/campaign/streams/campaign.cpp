#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/streams/simulated_stream.hpp"

namespace splinecast::campaign {
namespace {

/// Limit of the CPU time of one stream in s. A stream that exceeds it hangs, and SIGPROF ends the
/// program.
constexpr time_t kHangsAfter = 120;

volatile std::sig_atomic_t is_running = 0;
std::array<char, 96> hang_text{};

void report_hang(int /*signal*/) {
  if (is_running == 0) return;
  std::size_t length = 0;
  while (length < hang_text.size() && hang_text[length] != 0) ++length;
  (void)!write(STDERR_FILENO, hang_text.data(), length);
  _exit(3);
}

/// Ends the program with a message that names the seed if a stream hangs.
class HangGuard {
 public:
  explicit HangGuard(std::uint64_t seed) {
    std::snprintf(hang_text.data(), hang_text.size(),
                  "splinecast_campaign: seed %llu: hangs: unbounded step\n",
                  static_cast<unsigned long long>(seed));
    is_running = 1;
    (void)std::signal(SIGPROF, report_hang);
    limit(kHangsAfter);
  }
  HangGuard(const HangGuard&) = delete;
  HangGuard& operator=(const HangGuard&) = delete;
  ~HangGuard() {
    is_running = 0;
    limit(0);
  }

 private:
  static void limit(time_t seconds) {
    const itimerval once{.it_interval = {}, .it_value = {.tv_sec = seconds, .tv_usec = 0}};
    setitimer(ITIMER_PROF, &once, nullptr);
  }
};

void run_stream(std::uint64_t seed, StreamFindings& findings) {
  const HangGuard guard(seed);
  Random random(seed);
  const StreamPlan plan = make_plan(seed, random);
  SimulatedStream(plan, findings, random).run();
}

nlohmann::json found(const StreamFindings& findings, bool all_streams) {
  auto breaches = findings.found();
  breaches["hangs"] = 0;  // a hang ends the program
  if (!all_streams) return breaches;
  const auto missing = findings.not_covered();
  breaches["required events that never happened"] = missing.size();
  for (const std::string& name : missing) apps::say(fmt::format("never happened: {}", name));
  return breaches;
}

/// With the default seed this many streams have every required event.
constexpr std::uint64_t kHaveAllEvents = 300;

}  // namespace

Result run_streams(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  StreamFindings findings;
  const auto continues = [&] {
    return options.runs > 0 ? findings.streams() < options.runs : cpu_seconds() < options.seconds;
  };
  for (std::uint64_t seed = options.seed; continues() && !apps::stop_requested(); ++seed) {
    run_stream(seed, findings);
  }
  const double seconds = to_seconds(clock.now() - begin);
  const auto breaches = found(findings, options.runs == 0 || options.runs >= kHaveAllEvents);
  auto measured = findings.coverage();
  measured["simulated seconds per second"] = findings.simulated() / seconds;
  measured["first seed"] = options.seed;
  return make_result(
      options, {1, 2, 3, 4, 5, 8},
      "simulated streams: live streams, one per seed, with random producers, clocks, limits, kinds "
      "of dimensions and methods, replacements, stops, deaths and delays, through the real ring, "
      "solver, board and samplers in plain memory",
      findings.streams(), "streams", breaches, std::move(measured), seconds);
}

}  // namespace splinecast::campaign
