#include "splinecast/rate_commander.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ipc/law/commands.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/ring.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast {
namespace {

void require_length(const char* what, Time time) {
  if (time >= ipc::kShortestRamp && time <= ipc::kLongestRamp) return;
  throw BadRequest(std::string(what) + " must be 1 ms to 1 h, not " + std::to_string(time.count()) +
                   " ns");
}

}  // namespace

struct RateCommander::Impl {
  ipc::OwnerLock lock;
  ipc::OwnedRing ring;
  ipc::RateCommand command{.time = Time::min(), .rate = -1, .ramp = ipc::kShortestRamp};
  MonotonicClock clock;

  Impl(const std::string& stream, const ProducerOptions& options)
      : lock(stream, ipc::RegionKind::waypoints), ring(ipc::own_ring(stream, options, lock)) {
    lock.keep_file();
    continue_request();
  }

  /// Makes the last request of an earlier process of this name the one that renew() repeats.
  void continue_request() {
    if (ring.writer.written() == 0) return;
    ipc::RingItem item(ipc::kCommandValues);
    ipc::WaypointRingReader(ring.region.bytes(), ring.layout).copy(ring.writer.written() - 1, item);
    command = ipc::command_of(item).value_or(command);
  }

  void give() {
    const std::array values{command.rate, to_seconds(command.ramp), to_seconds(command.dead_man)};
    const ipc::Word written = ring.writer.written();
    // Two commands have different times. The law's solver only observes: there is always room.
    command.time = std::max(clock.now(), written > 0 ? ring.writer.last_time() + Time(1) : Time());
    const AppendStatus status =
        ring.writer.append({.time = command.time, .position = values}, {.consumed = written});
    if (status != AppendStatus::accepted) {
      throw BadRegion("the command was not accepted: " + std::string(to_string(status)));
    }
    ipc::wake_all(ring.writer.written_word());
  }
};

RateCommander::RateCommander(const std::string& law, const std::string& commander,
                             const RegionAccess& access, const Trust& trust)
    : impl_(std::make_unique<Impl>(ipc::commander_stream(law, commander),
                                   ipc::command_ring_options(access, trust))) {}
RateCommander::RateCommander(RateCommander&&) noexcept = default;
RateCommander& RateCommander::operator=(RateCommander&&) noexcept = default;
RateCommander::~RateCommander() = default;

void RateCommander::set_rate(double rate, Time ramp) {
  if (!(rate >= 0 && rate <= ipc::kLargestRate)) {
    throw BadRequest("a rate must be 0 to 100, not " + std::to_string(rate));
  }
  require_length("a ramp", ramp);
  impl_->command.rate = rate;
  impl_->command.ramp = ramp;
  impl_->give();
}

void RateCommander::release(Time ramp) {
  require_length("a ramp", ramp);
  impl_->command.rate = -1;
  impl_->command.ramp = ramp;
  impl_->give();
}

void RateCommander::set_dead_man(Time timeout) {
  if (timeout != Time::zero()) require_length("a dead man", timeout);
  impl_->command.dead_man = timeout;
}

void RateCommander::renew() { impl_->give(); }

}  // namespace splinecast
