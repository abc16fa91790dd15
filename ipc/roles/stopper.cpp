#include "splinecast/stopper.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "ipc/board/named_board.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/request.hpp"
#include "ipc/owned/stoppers.hpp"
#include "ipc/requests/record.hpp"
#include "ipc/requests/stoppers.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast {

struct Stopper::Impl {
  std::string name;  ///< of its region
  ipc::OwnerLock lock;
  ipc::OwnedRequest own;
  ipc::NamedBoard board;
  ipc::StopRequest request;  ///< the last one
  bool is_whole = true;      ///< it was made completely, by this process or an earlier one

  Impl(const std::string& stream, std::string region, const RegionAccess& access,
       const Trust& trust)
      : name(std::move(region)),
        lock(name, ipc::RegionKind::stopper),
        own(ipc::own_request(name, ipc::RegionKind::stopper, access, trust, lock)),
        board(stream, trust) {
    lock.keep_file();
    std::array<ipc::Word, ipc::kStopperRecordWords> words{};
    const ipc::RecordCopy left = ipc::copy_record(own.control, words);
    const auto last = left.is_whole ? ipc::stop_request_of(words) : std::nullopt;
    is_whole = last || left.is_unwritten();
    request = last.value_or(ipc::StopRequest{.number = words[0], .is_latched = !is_whole});
  }

  /// Makes a request, and throws afterwards if no process can find it.
  std::uint64_t make(bool is_latched) {
    // What is requested already is not written again: a solver that finds the record half written
    // takes it for a stop.
    if (!is_whole || request.is_latched != is_latched || request.number == 0) {
      request = {
          .number = request.number + 1, .time = MonotonicClock().now(), .is_latched = is_latched};
      is_whole = true;
      ipc::write_record(own.control, ipc::words_of(request));
    }
    if (own.region.is_linked(name, ipc::RegionKind::stopper)) return request.number;
    throw BadRegion(ipc::region_path(name, ipc::RegionKind::stopper) +
                    " has been removed: no solver can find the request");
  }

  [[nodiscard]] bool is_in_force(std::uint64_t number) {
    const auto all = ipc::stoppers_of(board.reader());
    const auto entry = std::ranges::find(all, own.id, &ipc::StopperEntry::id);
    return entry != all.end() && entry->number >= number;
  }
};

Stopper::Stopper(const std::string& stream, const std::string& stopper, const RegionAccess& access,
                 const Trust& trust)
    : impl_(std::make_unique<Impl>(stream, ipc::stopper_stream(stream, stopper), access, trust)) {}
Stopper::Stopper(Stopper&&) noexcept = default;
Stopper& Stopper::operator=(Stopper&&) noexcept = default;
Stopper::~Stopper() = default;

std::uint64_t Stopper::stop() { return impl_->make(true); }
std::uint64_t Stopper::release() { return impl_->make(false); }
bool Stopper::is_latched() const noexcept { return impl_->request.is_latched; }

bool Stopper::wait_in_force(std::uint64_t number, Time timeout) {
  constexpr Time kSlice = std::chrono::milliseconds(1);
  const MonotonicClock clock;
  const Time end = saturated_sum(clock.now(), timeout);
  for (;;) {
    const bool is_there = impl_->board.is_there();
    const ipc::Word seen = is_there ? impl_->board.reader().revision() : 0;
    if (is_there && impl_->is_in_force(number)) return true;
    const Time rest = std::min(end - clock.now(), kSlice);
    if (rest <= Time::zero()) return false;
    if (is_there) {
      impl_->board.wait(seen, rest);
    } else {
      std::this_thread::sleep_for(rest);
    }
  }
}

}  // namespace splinecast
