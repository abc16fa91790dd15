#include "apps/latency/iceoryx.hpp"

#ifndef SPLINECAST_HAS_ICEORYX

namespace splinecast::apps {

LatencyPeer measure_iceoryx(const LatencyOptions& /*options*/) {
  return {.seen = std::nullopt, .reason = "built without iceoryx (Debian: libiceoryx-posh-dev)"};
}

}  // namespace splinecast::apps

#else

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <iceoryx_posh/popo/untyped_publisher.hpp>
#include <iceoryx_posh/popo/untyped_subscriber.hpp>
#include <iceoryx_posh/popo/wait_set.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>
#include <vector>

#include "apps/latency/roles.hpp"
#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/shared_log.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {
namespace {

using ipc::Word;

/// iceoryx's daemon, as a child that ends with this object.
class Roudi {
 public:
  /// Throws Failure if it cannot be started.
  Roudi() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Failure("no pipe for a child process");
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      setpgid(0, 0);  // not for the terminal's Ctrl-C: the daemon must outlive its clients
      silence();
      execlp("iox-roudi", "iox-roudi", "-m", "off", "-l", "off", nullptr);
      const char failed = 1;
      [[maybe_unused]] const ssize_t written = write(ends[1], &failed, 1);
      _exit(kFailed);
    }
    close(ends[1]);
    char failed = 0;
    const bool has_failed = pid_ < 0 || read(ends[0], &failed, 1) == 1;  // EOF if exec succeeded
    close(ends[0]);
    if (!has_failed) return;
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    throw Failure("iox-roudi cannot be started (Debian: iceoryx)");
  }
  Roudi(const Roudi&) = delete;
  Roudi& operator=(const Roudi&) = delete;
  ~Roudi() {
    kill(pid_, SIGTERM);  // so that it removes its shared memory
    waitpid(pid_, nullptr, 0);
  }

  /// Discards standard output and error, on which iceoryx logs.
  static void silence() {
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }

 private:
  pid_t pid_ = -1;
};

/// The payload: the item's number, then as many bytes as a waypoint's ring item has.
std::uint32_t payload_bytes(const LatencyOptions& options) {
  return static_cast<std::uint32_t>(sizeof(Word) * (2 + 3 * options.dimensions));
}

iox::capro::ServiceDescription service_of(pid_t parent) {
  const iox::capro::IdString_t instance(iox::cxx::TruncateToCapacity,
                                        std::to_string(parent).c_str());
  return {"splinecast", instance, "latency"};
}

/// Registers this process with the daemon and unregisters it. A child ends by _exit, which runs no
/// destructors of static objects; a daemon with a client that did not unregister aborts at its end
/// and does not remove its shared memory.
class Registration {
 public:
  Registration(const char* role, pid_t parent) {
    const std::string name = fmt::format("splinecast-{}-{}", role, parent);
    iox::runtime::PoshRuntime::initRuntime(
        iox::RuntimeName_t(iox::cxx::TruncateToCapacity, name.c_str()));
  }
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;
  ~Registration() { iox::runtime::PoshRuntime::getInstance().~PoshRuntime(); }
};

struct IceoryxShared {
  explicit IceoryxShared(const LatencyOptions& options)
      : appends(options.schedule({}).count), seen(options.schedule({}).count) {}
  Shared<Meeting> meeting;
  SharedLog<AppendStamp> appends;
  SharedLog<SeenStamp> seen;
};

void run_publisher(const LatencyOptions& options, pid_t parent, IceoryxShared& shared) {
  (void)adopt(options.settings(options.cpu_producer), {});  // the pipeline's processes warn
  shared.appends.touch();
  Roudi::silence();
  const Registration registration("producer", parent);
  iox::popo::UntypedPublisher publisher(service_of(parent));
  const std::vector<double> waypoint(3 * options.dimensions, 1.0);
  const MonotonicClock clock;
  const Schedule schedule = options.schedule(shared.meeting->begin(1));
  run(
      schedule, [&](Time instant) { return wait_for_instant(instant, options.spin); },
      [&](std::size_t k, Time intended) {
        const Word item = k;
        AppendStamp stamp{.item = kRefusedItem, .intended = intended, .begun = clock.now()};
        publisher.loan(payload_bytes(options)).and_then([&](void* payload) {
          auto* const bytes = static_cast<std::byte*>(payload);
          std::memcpy(bytes, &item, sizeof item);
          std::memcpy(bytes + 2 * sizeof item, waypoint.data(), waypoint.size() * sizeof(double));
          publisher.publish(payload);
          stamp.item = item;
        });
        stamp.appended = clock.now();
        (void)shared.appends.push(stamp);
      });
  shared.meeting->last_revision.store(schedule.count, std::memory_order_release);
}

/// Takes all samples that have arrived; sample k counts as revision k + 1. Returns the last one.
Word take_all(iox::popo::UntypedSubscriber& subscriber, IceoryxShared& shared) {
  const MonotonicClock clock;
  Word last = 0;
  for (bool more = true; more;) {
    more = false;
    subscriber.take().and_then([&](const void* payload) {
      Word item = 0;
      std::memcpy(&item, payload, sizeof item);
      (void)shared.seen.push({.revision = item + 1, .seen = clock.now()});
      last = item + 1;
      subscriber.release(payload);
      more = true;
    });
  }
  return last;
}

void run_subscriber(const LatencyOptions& options, pid_t parent, IceoryxShared& shared) {
  (void)adopt(options.settings(options.cpu_reader(0)), {});
  shared.seen.touch();
  Roudi::silence();
  const Registration registration("reader", parent);
  iox::popo::SubscriberOptions how;
  how.queueCapacity = 256;  // its maximum
  iox::popo::UntypedSubscriber subscriber(service_of(parent), how);
  iox::popo::WaitSet<> set;
  if (!options.spin) {
    set.attachState(subscriber, iox::popo::SubscriberState::HAS_DATA).or_else([](auto) {
      throw Failure("iceoryx has no wait set");
    });
  }
  if (!shared.meeting->await_start()) throw TimeOut("the publisher did not start");
  const MonotonicClock clock;
  constexpr Time kLongestWait = std::chrono::milliseconds(50);
  constexpr Time kGrace = std::chrono::seconds(1);  // for the last samples
  Word seen = 0;
  for (Time end = Time::max(); !stop_requested() && clock.now() < end;) {
    if (!options.spin) {
      (void)set.timedWait(iox::units::Duration::fromNanoseconds(kLongestWait.count()));
    }
    seen = std::max(seen, take_all(subscriber, shared));
    const Word last = shared.meeting->last_revision.load(std::memory_order_acquire);
    if (last == 0) continue;
    if (seen >= last) return;
    if (end == Time::max()) end = clock.now() + kGrace;
  }
}

}  // namespace

LatencyPeer measure_iceoryx(const LatencyOptions& options) {
  IceoryxShared shared(options);
  const pid_t parent = getpid();
  try {
    const Roudi roudi;
    Child subscriber([&] {
      run_subscriber(options, parent, shared);
      return nlohmann::json();
    });
    Child publisher([&] {
      run_publisher(options, parent, shared);
      return nlohmann::json();
    });
    publisher.result();
    subscriber.result();
  } catch (const std::exception& error) {
    return {.seen = std::nullopt, .reason = error.what()};
  }
  if (shared.seen.entries().empty()) return {.seen = std::nullopt, .reason = "nothing arrived"};
  const Time start(shared.meeting->start_ns.load(std::memory_order_relaxed));
  const Measured measured = options.measured(start);
  // A sample is complete when it is sent: its number + 1 serves as its revision.
  std::vector<RevisionStamp> revisions;
  for (const AppendStamp& append : shared.appends.entries()) {
    if (append.item == kRefusedItem) continue;
    revisions.push_back({.revision = append.item + 1,
                         .consumed = append.item + 1,
                         .solved = append.appended,
                         .published = append.appended});
  }
  auto stages =
      latencies_of(shared.appends.entries(), revisions, {shared.seen.entries()}, {}, measured);
  stages.back().stage = "iceoryx";
  return {.seen = std::move(stages.back()), .reason = {}};
}

}  // namespace splinecast::apps

#endif
