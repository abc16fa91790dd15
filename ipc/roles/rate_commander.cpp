#include "splinecast/rate_commander.hpp"

#include <utility>

#include "ipc/law/commander_record.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/commander.hpp"
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
  std::string name;
  ipc::OwnerLock lock;
  ipc::OwnedCommander own;
  ipc::RateCommand command;  ///< the last one
  bool may_renew = false;    ///< it was made completely, by this process or an earlier one
  Time dead_man{};           ///< of the next request
  Time dead_man_ramp = ipc::kDeadManRamp;

  Impl(std::string region, const RegionAccess& access, const Trust& trust)
      : name(std::move(region)),
        lock(name, ipc::RegionKind::commander),
        own(ipc::own_commander(name, access, trust, lock)) {
    lock.keep_file();
    const ipc::CommandCopy left = ipc::copy_command(own.control);
    const auto last = left.is_whole ? ipc::command_of(left.words) : std::nullopt;
    may_renew = last.has_value();
    command = last.value_or(command);
    command.number = left.words[0];  // also of a request that was not completed
  }

  void request(double rate, Time ramp) {
    ++command.number;
    command.rate = rate;
    command.ramp = ramp;
    command.dead_man = dead_man;
    command.dead_man_ramp = dead_man_ramp;
    may_renew = true;
    write();
  }

  /// Writes the command, and throws afterwards if no process can find it.
  void write() {
    command.time = MonotonicClock().now();
    ipc::write_command(own.control, command);
    ipc::wake_all(own.control[ipc::kCommanderSequence]);
    if (own.region.is_linked(name, ipc::RegionKind::commander)) return;
    throw BadRegion(ipc::region_path(name, ipc::RegionKind::commander) +
                    " has been removed: no solver can find the request");
  }
};

RateCommander::RateCommander(const std::string& law, const std::string& commander,
                             const RegionAccess& access, const Trust& trust)
    : impl_(std::make_unique<Impl>(ipc::commander_stream(law, commander), access, trust)) {}
RateCommander::RateCommander(RateCommander&&) noexcept = default;
RateCommander& RateCommander::operator=(RateCommander&&) noexcept = default;
RateCommander::~RateCommander() = default;

void RateCommander::set_rate(double rate, Time ramp) {
  if (!(rate >= 0 && rate <= ipc::kLargestRate)) {
    throw BadRequest("a rate must be 0 to 100, not " + std::to_string(rate));
  }
  require_length("a ramp", ramp);
  impl_->request(rate, ramp);
}

void RateCommander::release(Time ramp) {
  require_length("a ramp", ramp);
  impl_->request(-1, ramp);
}

void RateCommander::set_dead_man(Time timeout, Time ramp) {
  if (timeout != Time::zero()) require_length("a dead man", timeout);
  require_length("a ramp", ramp);
  impl_->dead_man = timeout;
  impl_->dead_man_ramp = ramp;
}

void RateCommander::renew() {
  if (impl_->may_renew) impl_->write();
}

}  // namespace splinecast
