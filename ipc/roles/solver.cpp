#include "splinecast/solver.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "ipc/board/writer.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/board.hpp"
#include "ipc/requests/stoppers.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/roles/law_server.hpp"
#include "ipc/roles/refusals.hpp"
#include "ipc/roles/solver_watch.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/errors.hpp"

namespace splinecast {
namespace {

/// Maximum length of one futex wait: retiring a ring does not change the futex word, so its wake
/// can be missed.
constexpr Time kSlice = std::chrono::milliseconds(50);
/// How often a solver without a stream looks for one.
constexpr Time kPoll = std::chrono::milliseconds(5);

/// The same for a stream that has a stopper, whose requests do not wake the solver.
constexpr Time kSliceOfStopped = std::chrono::milliseconds(5);

/// How often a solver that does not sleep looks for new stoppers, by a coarse clock (4 ms).
constexpr Time kPollInterval = std::chrono::milliseconds(1);

/// How often the solver of a stream whose law holds looks at the law.
constexpr Time kHeldPoll = std::chrono::milliseconds(5);

/// The region of the producer.
using RingView = ipc::RegionView<ipc::WaypointRingReader>;

/// What a solver owns while it is attached.
struct Attachment {
  RingView ring;
  ipc::OwnedBoard board;
  ipc::StreamSolver solver;
  std::unique_ptr<ipc::Stoppers> stoppers;  ///< of a live stream that is not a law
  std::unique_ptr<ipc::LawFollower> law;    ///< of a stream that follows one
  Time held_until = Time::min();            ///< host time before which a held law needs no step
  ipc::RefusalReader refusals;
  Refusals refused;
  ipc::Word refusals_seen;
  ipc::Word excesses_seen;
  bool is_excess_reported = false;
  std::array<bool, ipc::kRefusalReasons> reported{};  ///< by Refusal

  Attachment(RingView producer, ipc::OwnedBoard own)
      : ring(std::move(producer)),
        board(std::move(own)),
        solver(ring.reader, board.writer, board.reader, ipc::window_options(board.header),
               ipc::interval_range(ring.header), ipc::dimension_kinds(ring.header),
               ipc::live_options(board.header), ipc::beyond(board.header)),
        refusals_seen(solver.summary().refused),
        excesses_seen(solver.summary().exceeding) {
    refusals.skip(board.reader);
    refused.items.reserve(ipc::kRefusalsKept);
  }

  StepResult step(const Clock& host) {
    if (!law) return solver.step(host);
    const ipc::LawClock stream_clock(*law, host);
    const StepResult result = solver.step(stream_clock);
    held_until = stream_clock.is_held() ? host.now() + kHeldPoll : Time::min();
    return result;
  }

  [[nodiscard]] Time due() const noexcept { return std::max(solver.due(), held_until); }
};

}  // namespace

struct Solver::Impl {
  std::string stream;
  SolverOptions options;
  std::unique_ptr<ipc::RegionWatch> own_watch;  ///< ends after the lock
  ipc::OwnerLock lock;
  const ipc::RegionWatch* watch = nullptr;  ///< of this object, or of its caller
  Time next_poll = Time::min();             ///< of own_watch; min(): at once
  std::unique_ptr<ipc::LawServer> server;   ///< if the stream is a law
  std::unique_ptr<Attachment> attachment;
  Time next_attach = Time::min();

  Impl(std::string name, const SolverOptions& how)
      : stream(std::move(name)),
        options((ipc::require_stream_name(stream), ipc::require_options(how), how)),
        lock(stream, ipc::RegionKind::spline) {
    try {
      // Throws now, not when a producer appears, if the existing board cannot be taken over.
      if (ipc::region_exists(stream, ipc::RegionKind::spline))
        (void)ipc::open_board(stream, true, options.trust);
    } catch (const StreamError&) {
      lock.remove_unused_file();
      throw;
    }
  }

  ~Impl() { lock.remove_unused_file(); }

  /// Becomes the producer of the stream if it is a law. Returns whether the stream has a ring.
  bool serve_law() {
    if (server) return true;
    const bool has_ring = ipc::region_exists(stream, ipc::RegionKind::waypoints);
    if (has_ring) {
      const auto peeked = ipc::peek_header(stream, ipc::RegionKind::waypoints, options.trust);
      if (!peeked || peeked->is_law == 0) return true;
    }
    poll_watch();
    if (!ipc::LawServer::is_wanted(stream, *watch)) return has_ring;
    server = std::make_unique<ipc::LawServer>(stream, options, *watch);
    return true;
  }

  void poll_watch() {
    if (watch == nullptr) {
      own_watch = std::make_unique<ipc::RegionWatch>();
      watch = own_watch.get();
    }
    if (own_watch) own_watch->poll();
  }

  /// Whether wait() looks for new stoppers instead of step(), which makes no system call then.
  [[nodiscard]] bool polls_in_wait() const noexcept { return own_watch && !options.wake; }

  /// The same for the stoppers of the stream, at most every kPollInterval while the solver does not
  /// sleep. If that fails, the next call tries again: the curve continues.
  void poll_stoppers(Time now) noexcept {
    try {
      if (own_watch && (now >= next_poll || now < next_poll - kPollInterval)) {
        next_poll = now + kPollInterval;
        own_watch->poll();
      }
      attachment->stoppers->poll(now);
    } catch (const std::exception&) {
      next_poll = Time::min();
    }
  }

  /// Opens the law that a stream follows. Returns false if there is none, or if it has not begun.
  bool find_law(const ipc::RegionHeader& header, const Clock& clock,
                std::unique_ptr<ipc::LawFollower>& law) const {
    try {
      law = std::make_unique<ipc::LawFollower>(header, options.trust);
    } catch (const LawLost&) {
      throw;
    } catch (const NoSuchStream&) {
      return false;
    }
    ipc::LawPoint point;
    return has_values(law->at(clock.now(), point));
  }

  /// The stoppers of a live stream, as they are before its first step; null for others.
  std::unique_ptr<ipc::Stoppers> find_stoppers(const ipc::RegionHeader& header,
                                               const Clock& clock) {
    if (server || !is_live(ipc::stream_clock(header))) return nullptr;
    poll_watch();
    auto stoppers = std::make_unique<ipc::Stoppers>(stream, options.trust, *watch);
    stoppers->poll(clock.now());
    return stoppers;
  }

  bool attach(const Clock& clock) {
    RingView ring(ipc::open_ring(stream, false, options.trust));
    const ipc::RegionHeader& header = ring.header;
    ipc::require_same_clock(header, stream);
    if (ring.reader.retired()) return false;
    std::unique_ptr<ipc::LawFollower> law;
    if (header.law_id != 0 && !find_law(header, clock, law)) {
      next_attach = clock.now() + kPoll;
      return false;
    }
    auto stoppers = find_stoppers(header, clock);
    const SolverOptions how = server ? ipc::LawServer::solver_options(options) : options;
    auto board = ipc::own_board(stream, header, how, clock);
    if (const auto* const occupied = std::get_if<ipc::Occupied>(&board)) {
      next_attach = occupied->until;
      return false;
    }
    attachment =
        std::make_unique<Attachment>(std::move(ring), std::get<ipc::OwnedBoard>(std::move(board)));
    attachment->law = std::move(law);
    if (server) {
      server->attach(attachment->board.reader, attachment->board.header);
      attachment->solver.plan_with(*server);
    }
    if (stoppers) attachment->solver.heed(*stoppers);
    attachment->stoppers = std::move(stoppers);
    lock.keep_file();
    return true;
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

Solver::Solver(std::string stream, const SolverOptions& options)
    : impl_(std::make_unique<Impl>(std::move(stream), options)) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

void Solver::require(const SolverOptions& options) { ipc::require_options(options); }

bool Solver::attach() { return attach(MonotonicClock()); }

bool Solver::attach(const Clock& clock) {
  if (attached()) return true;
  if (impl_->next_attach > Time::min() && clock.now() < impl_->next_attach) return false;
  impl_->next_attach = Time::min();
  try {
    return impl_->serve_law() && impl_->attach(clock);
  } catch (const LawLost&) {
    throw;
  } catch (const NoSuchStream&) {
    return false;  // removed between the check and the opening
  }
}

bool Solver::attached() const noexcept { return impl_->attachment != nullptr; }

StepResult Solver::step(const Clock& clock) {
  if (!attached()) return {};
  Attachment& at = *impl_->attachment;
  if (impl_->server) {
    impl_->poll_watch();
    impl_->server->poll(clock);
  } else if (at.stoppers && !impl_->polls_in_wait()) {
    impl_->poll_stoppers(clock.about_now());
  }
  const StepResult result = at.step(clock);
  if (result.damaged) {
    throw BadRegion(ipc::region_path(impl_->stream, ipc::RegionKind::spline) +
                    " holds data that its solver did not write");
  }
  if (result.published && impl_->options.wake) {
    ipc::wake_some(at.board.writer.revision_word());
    (void)at.board.lock.hold();
  }
  const bool is_idle = result.consumed == 0 && !result.missed && !at.solver.is_postponed();
  if (is_idle && at.ring.reader.retired()) {
    impl_->attachment.reset();
    impl_->server.reset();
  }
  return result;
}

Time Solver::due() const noexcept {
  if (attached()) {
    const Time due = impl_->attachment->due();
    return impl_->server ? std::min(due, impl_->server->due()) : due;
  }
  return impl_->next_attach > Time::min() ? impl_->next_attach : Time::max();
}

void Solver::wait(Time timeout) noexcept {
  if (!attached()) {
    std::this_thread::sleep_for(std::min(timeout, kPoll));
    return;
  }
  Attachment& at = *impl_->attachment;
  (void)at.board.lock.hold();
  if (at.stoppers && impl_->polls_in_wait()) impl_->poll_stoppers(MonotonicClock().now());
  if (timeout <= Time::zero()) return;
  // The store and the load are seq_cst, as are the producer's store of its written position and its
  // load of sleeping: either this load sees the new position, or the producer sees that this solver
  // must be woken.
  at.board.writer.store_sleeping(true);
  const ipc::Word written = at.ring.reader.written(std::memory_order_seq_cst);
  const Time due = this->due();
  const Time now = due < Time::max() ? MonotonicClock().now() : Time::zero();
  if (written == at.solver.seen() && due > now && !at.ring.reader.retired()) {
    const Time slice = at.stoppers && at.stoppers->is_used() ? kSliceOfStopped : kSlice;
    const Time most = std::min({timeout, slice, due - now});
    if (!impl_->server) {
      ipc::wait_while_equal(at.ring.reader.written_word(), written, most);
      impl_->next_poll = Time::min();
    } else {
      impl_->server->commanders().wait(most);
    }
  }
  at.board.writer.store_sleeping(false);
}

void Solver::take_first_refusals(std::vector<ItemRefusal>& out) {
  out.clear();
  if (!attached()) return;
  Attachment& at = *impl_->attachment;
  if (at.solver.summary().refused == at.refusals_seen) return;
  at.refusals_seen = at.solver.summary().refused;
  at.refusals.look(at.board.reader, at.ring.reader, at.refused);
  for (const ItemRefusal& refusal : at.refused.items) {
    bool& reported = at.reported[static_cast<std::size_t>(refusal.reason) % at.reported.size()];
    if (!reported) out.push_back(refusal);
    reported = true;
  }
}

std::optional<LimitExcess> Solver::take_first_excess() noexcept {
  if (!attached() || impl_->attachment->is_excess_reported) return std::nullopt;
  Attachment& at = *impl_->attachment;
  const ipc::Summary& summary = at.solver.summary();
  while (at.excesses_seen < summary.exceeding) {
    const auto excess = at.board.reader.excess(summary, at.excesses_seen++);
    at.is_excess_reported = excess && !excess->is_refused;
    if (at.is_excess_reported) return excess;
  }
  return std::nullopt;
}

void Solver::take_commander_faults(std::vector<std::string>& out) {
  if (impl_->server) impl_->server->take_faults(out);
  if (attached() && impl_->attachment->stoppers) impl_->attachment->stoppers->take_faults(out);
}

std::string Solver::in_words(const LimitExcess& excess) const {
  return "item " + std::to_string(excess.item) + ", " +
         splinecast::in_words(excess, ipc::dimension_names(impl_->attachment->board.header));
}

bool Solver::took_over() const noexcept {
  return attached() && impl_->attachment->board.taken_over;
}
bool Solver::is_memory_locked() const noexcept {
  return attached() && impl_->attachment->board.region.is_memory_locked();
}
const std::string& Solver::stream() const noexcept { return impl_->stream; }

namespace ipc {

const ipc::Summary& ipc::Internals::summary(const Solver& solver) noexcept {
  return solver.impl_->attachment->solver.summary();
}

std::optional<LimitExcess> ipc::Internals::worst_excess(const Solver& solver) noexcept {
  return solver.impl_->attachment->board.reader.worst_excess();
}

const ipc::RegionHeader& ipc::Internals::board(const Solver& solver) noexcept {
  return solver.impl_->attachment->board.header;
}

void ipc::Internals::share(Solver& solver, const RegionWatch& watch) noexcept {
  solver.impl_->watch = &watch;
}

bool ipc::Internals::hold_region(Solver& solver) noexcept {
  return !solver.attached() || solver.impl_->attachment->board.lock.hold();
}

void ipc::Internals::prefetch(const Solver& solver, Stage stage) noexcept {
  if (stage == Stage::self) return ipc::prefetch_lines(solver.impl_.get(), sizeof(Solver::Impl));
  if (!solver.attached()) return;
  const Attachment& at = *solver.impl_->attachment;
  if (stage == Stage::parts) {
    ipc::prefetch_lines(&at.ring.reader, sizeof(at.ring.reader));
    ipc::prefetch_lines(&at.board.writer, sizeof(at.board.writer));
    ipc::prefetch_lines(&at.board.reader, sizeof(at.board.reader));
    ipc::prefetch_lines(&at.solver, sizeof(at.solver));
  } else {
    at.solver.prefetch();
  }
}

ipc::SolverWatch ipc::Internals::watch(const Solver& solver) noexcept {
  const Attachment& at = *solver.impl_->attachment;
  const ipc::LawServer* const server = solver.impl_->server.get();
  if (server == nullptr) {
    return {at.ring.reader.polled(), at.solver.seen(), solver.due(), at.solver.settled_raise(),
            at.stoppers ? &at.stoppers->regions() : nullptr};
  }
  // A step of a law also looks for commanders: raising the settled time does not replace it.
  return {
      at.ring.reader.polled(), at.solver.seen(), solver.due(), {}, &server->commanders().regions()};
}

}  // namespace ipc
}  // namespace splinecast
