#include "splinecast/rate_commander.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "core/basics/number_text.hpp"
#include "ipc/law/commander_record.hpp"
#include "ipc/law/law_board.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/request.hpp"
#include "ipc/requests/record.hpp"
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
  std::string law;
  std::string name;
  ipc::OwnerLock lock;
  ipc::LawBoard board;
  ipc::OwnedRequest own;
  ipc::RateCommand command;  ///< the last one
  bool may_renew = false;    ///< it was made completely, by this process or an earlier one
  Time dead_man{};           ///< of the next request
  Time dead_man_ramp = ipc::kDeadManRamp;

  Impl(std::string of_law, std::string region, const RegionAccess& access, const Trust& trust)
      : law(std::move(of_law)),
        name(std::move(region)),
        lock(name, ipc::RegionKind::commander),
        board(law, trust),
        own(ipc::own_request((require_slot(trust), name), ipc::RegionKind::commander, access, trust,
                             lock)) {
    lock.keep_file();
    std::array<ipc::Word, ipc::kCommanderRecordWords> words{};
    const bool is_whole = ipc::copy_record(own.control, words).is_whole;
    const auto last = is_whole ? ipc::command_of(words) : std::nullopt;
    may_renew = last.has_value();
    command = last.value_or(command);
    command.number = words[0];  // also of a request that was not completed
  }

  /// Throws OutOfResources if the law knows as many commanders as it can, and not this one.
  void require_slot(const Trust& trust) {
    if (!board.is_there()) return;
    const auto known = board.commanders();
    if (known.size() < ipc::kMostCommanders) return;
    const auto header = ipc::peek_header(name, ipc::RegionKind::commander, trust);
    const ipc::Word id = header ? header->stream_id : 0;
    if (std::ranges::find(known, id, &ipc::CommanderEntry::id) != known.end()) return;
    std::string names;
    for (const ipc::CommanderEntry& entry : known) {
      names.append(names.empty() ? "" : ", ").append(ipc::name_of(entry));
    }
    lock.remove_unused_file();
    throw OutOfResources("'" + law + "' has " + std::to_string(known.size()) +
                         " commanders, as many as a law can have; release one of them whose "
                         "process has ended: " +
                         names);
  }

  [[nodiscard]] std::uint64_t request(double rate, Time ramp) {
    ++command.number;
    command.rate = rate;
    command.ramp = ramp;
    command.dead_man = dead_man;
    command.dead_man_ramp = dead_man_ramp;
    may_renew = true;
    write();
    return command.number;
  }

  /// Whether the dead man of the last request has fired, as far as the law's board shows.
  [[nodiscard]] bool has_died() noexcept {
    if (command.dead_man == Time::zero() || !board.is_there()) return false;
    const auto entry = board.commander(own.id);
    return entry && entry->is_dead && entry->number == command.number;
  }

  /// Writes the command, and throws afterwards if no process can find it.
  void write() {
    command.time = MonotonicClock().now();
    ipc::write_command(own.control, command);
    ipc::wake_all(own.control[ipc::kRecordSequence]);
    if (own.region.is_linked(name, ipc::RegionKind::commander)) return;
    throw BadRegion(ipc::region_path(name, ipc::RegionKind::commander) +
                    " has been removed: no solver can find the request");
  }
};

RateCommander::RateCommander(const std::string& law, const std::string& commander,
                             const RegionAccess& access, const Trust& trust)
    : impl_(std::make_unique<Impl>(law, ipc::commander_stream(law, commander), access, trust)) {}
RateCommander::RateCommander(RateCommander&&) noexcept = default;
RateCommander& RateCommander::operator=(RateCommander&&) noexcept = default;
RateCommander::~RateCommander() = default;

std::uint64_t RateCommander::set_rate(double rate, Time ramp) {
  if (!(rate >= 0 && rate <= ipc::kLargestRate)) {
    throw BadRequest("a rate must be 0 to 100, not " + std::to_string(rate));
  }
  require_length("a ramp", ramp);
  if (rate > 0 && impl_->board.is_there() && rate > impl_->board.max_rate()) {
    throw BadRequest("the largest rate of '" + impl_->law + "' is " +
                     core::number_text(impl_->board.max_rate()) + ", not " +
                     core::number_text(rate));
  }
  return impl_->request(rate, ramp);
}

std::uint64_t RateCommander::release(Time ramp) {
  require_length("a ramp", ramp);
  return impl_->request(-1, ramp);
}

bool RateCommander::wait_in_force(std::uint64_t number, Time timeout) {
  constexpr Time kSlice = std::chrono::milliseconds(1);
  const MonotonicClock clock;
  const Time end = saturated_sum(clock.now(), timeout);
  for (;;) {
    const bool is_there = impl_->board.is_there();
    const auto entry = is_there ? impl_->board.commander(impl_->own.id) : std::nullopt;
    if (entry && entry->number >= number) return true;
    const Time rest = std::min(end - clock.now(), kSlice);
    if (rest <= Time::zero()) return false;
    if (is_there) {
      impl_->board.wait(rest);
    } else {
      std::this_thread::sleep_for(rest);
    }
  }
}

void RateCommander::set_dead_man(Time timeout, Time ramp) {
  if (timeout != Time::zero()) require_length("a dead man", timeout);
  require_length("a ramp", ramp);
  impl_->dead_man = timeout;
  impl_->dead_man_ramp = ramp;
}

bool RateCommander::renew() {
  if (!impl_->may_renew) return true;
  if (impl_->has_died()) return false;
  impl_->write();
  return true;
}

}  // namespace splinecast
