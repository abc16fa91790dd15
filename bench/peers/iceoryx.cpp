#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <iceoryx_hoofs/log/logmanager.hpp>
#include <iceoryx_posh/popo/publisher.hpp>
#include <iceoryx_posh/popo/subscriber.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>
#include <optional>
#include <stdexcept>

#include "bench/harness/roundtrip.hpp"

/// Eclipse iceoryx, with its own daemon: round trips of the same payload, polled.
namespace splinecast::bench {
namespace {

/// The contents of a waypoint of a round trip.
struct Payload {
  std::uint64_t number;
  std::int64_t time_ns;
  std::array<double, kTripDimensions> position;
};

/// One side of a round trip: publishes under one name and subscribes to another.
class Side {
 public:
  Side(const char* process, const char* sends, const char* takes)
      : runtime_(iox::runtime::PoshRuntime::initRuntime({iox::cxx::TruncateToCapacity, process})),
        publisher_({"splinecast_bench", "roundtrip", {iox::cxx::TruncateToCapacity, sends}},
                   {.historyCapacity = 0}),
        subscriber_({"splinecast_bench", "roundtrip", {iox::cxx::TruncateToCapacity, takes}},
                    {.queueCapacity = 2, .historyRequest = 0}) {}

  /// Whether both directions are connected.
  [[nodiscard]] bool is_connected() {
    return publisher_.hasSubscribers() &&
           subscriber_.getSubscriptionState() == iox::SubscribeState::SUBSCRIBED;
  }

  void send(std::uint64_t i) {
    publisher_.loan()
        .and_then([&](auto& sample) {
          sample->number = i;
          sample->time_ns = time_of(i).count();
          sample->position.fill(static_cast<double>(i % 16));
          sample.publish();
        })
        .or_else([](auto&) { throw std::runtime_error("iceoryx has no free sample to loan"); });
  }

  /// Polls until payload i has arrived; false if a stop is requested.
  bool await(std::uint64_t i) {
    for (;;) {
      std::uint64_t number = 0;
      subscriber_.take().and_then([&](auto& sample) {
        number = sample->number;
        benchmark::DoNotOptimize(sample->position);
      });
      if (number == i) return true;
      if (apps::stop_requested()) return false;
    }
  }

 private:
  iox::runtime::PoshRuntime& runtime_;
  iox::popo::Publisher<Payload> publisher_;
  iox::popo::Subscriber<Payload> subscriber_;
};

/// The daemon that the two sides need; it ends with this process.
[[nodiscard]] apps::Child start_daemon() {
  return apps::Child([]() -> nlohmann::json {
    const int nowhere = open("/dev/null", O_WRONLY);  // it reports its start on any log level
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execl(SPLINECAST_ROUDI, SPLINECAST_ROUDI, "--log-level", "off", "--monitoring-mode", "off",
          nullptr);
    throw std::runtime_error(SPLINECAST_ROUDI " does not start");
  });
}

nlohmann::json answer(const SharedLines& lines) {
  const Pinned pin(kFar);
  Side side("splinecast_bench_far", "back", "there");
  while (!side.is_connected() && !apps::stop_requested()) {
  }
  lines[kFarIsReady].store(1, std::memory_order_release);
  for (std::uint64_t i = 2; side.await(i); ++i) side.send(i);
  return nullptr;
}

void roundtrip(benchmark::State& bench) {
  iox::log::LogManager::GetLogManager().SetDefaultLogLevel(iox::log::LogLevel::kOff,
                                                           iox::log::LogLevelOutput::kHideLogLevel);
  const apps::Child daemon = start_daemon();
  for (auto _ : bench) {
    const SharedLines lines;
    apps::Child far([&] { return answer(lines); });
    apps::Child near([&] {
      const Pinned pin(kNear);
      Side side("splinecast_bench_near", "there", "back");
      while (!side.is_connected() && !apps::stop_requested()) {
      }
      await(lines[kFarIsReady], 1);
      return measure([&](std::uint64_t i) {
        side.send(i);
        return side.await(i);
      });
    });
    report(bench, near.result());
    far.stop();
    far.result();
  }
}

BENCHMARK(roundtrip)->Name("iceoryx/roundtrip")->Iterations(1)->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
