#include "splinecast/solver.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "ipc/board/writer.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/roles/old_motion.hpp"
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

/// The producer's region, as the solver reads it.
struct RingView {
  ipc::Region region;
  ipc::RegionHeader header;
  ipc::WaypointRingReader ring;

  RingView(ipc::Region mapped, const ipc::RegionHeader& described, const ipc::RingLayout& layout)
      : region(std::move(mapped)), header(described), ring(region.bytes(), layout) {
    region.close_descriptor();
  }
};

/// The solver's own region, created or taken over.
struct OwnedBoard {
  ipc::Region region;
  ipc::RegionLock lock;
  ipc::RegionHeader header;
  bool taken_over;
  ipc::KnotBoardWriter writer;
  ipc::KnotBoardReader reader;

  OwnedBoard(ipc::Region mapped, const ipc::RegionHeader& described, const ipc::BoardLayout& layout,
             bool old)
      : region(std::move(mapped)),
        lock(region.descriptor()),
        header(described),
        taken_over(old),
        writer(region.bytes(), layout),
        reader(region.bytes(), layout) {}
};

OwnedBoard make_board(const std::string& stream, const ipc::RegionHeader& ring_header,
                      const SolverOptions& options) {
  ipc::RegionHeader header = ring_header;
  header.kind = static_cast<std::uint64_t>(ipc::RegionKind::spline);
  ipc::write_options(options, header);
  const auto layout = ipc::BoardLayout::of(header.dimensions, header.capacity, header.control,
                                           ipc::smooths(header));
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  header.epoch = 0;
  ipc::Region region = ipc::Region::create(layout.bytes, options.access);
  ipc::write_header(region.bytes(), header);
  ipc::enter_owner(region.bytes(), header);
  OwnedBoard board(std::move(region), header, layout, false);
  if (!board.region.link(stream, ipc::RegionKind::spline)) {
    throw BadRegion(ipc::region_path(stream, ipc::RegionKind::spline) +
                    " was created by another process at the same time");
  }
  return board;
}

/// The board of an earlier stream occupies the name until this time, when its motion ends.
struct Occupied {
  Time until;
};

std::variant<OwnedBoard, Occupied> own_board(const std::string& stream,
                                             const ipc::RegionHeader& ring_header,
                                             const SolverOptions& options, const Clock& clock) {
  if (!ipc::region_exists(stream, ipc::RegionKind::spline))
    return make_board(stream, ring_header, options);
  auto [region, header, layout] = ipc::open_board(stream, true, options.trust);
  OwnedBoard board(std::move(region), header, layout, true);
  if (header.stream_id != ring_header.stream_id || board.reader.retired()) {
    // Readers follow the old curve to its end: they must not find another one during the motion.
    const Time end = ipc::end_of_motion(header, board.reader);
    const Time now = clock.now();
    ipc::require_near_end(stream, end, now);
    if (now < end) return Occupied{end};
    board.writer.retire();
    ipc::wake_all(board.writer.revision_word());
    ipc::unlink_region(stream, ipc::RegionKind::spline);
    return make_board(stream, ring_header, options);
  }
  ipc::require_same_stream(ring_header, header);
  ipc::require_same_options(stream, header, options);
  ipc::enter_owner(board.region.bytes(), header);
  board.writer.store_sleeping(false);
  return board;
}

/// What a solver owns while it is attached.
struct Attachment {
  RingView ring;
  OwnedBoard board;
  ipc::StreamSolver solver;
  ipc::RefusalReader refusals;
  Refusals refused;
  ipc::Word refusals_seen;
  ipc::Word excesses_seen;
  bool is_excess_told = false;
  std::array<bool, ipc::kRefusalReasons> told{};  ///< by Refusal

  Attachment(RingView producer, OwnedBoard own)
      : ring(std::move(producer)),
        board(std::move(own)),
        solver(ring.ring, board.writer, board.reader, ipc::window_options(board.header),
               ipc::ingest_limits(ring.header), ipc::dimension_kinds(ring.header),
               ipc::live_options(board.header), ipc::beyond(board.header)),
        refusals_seen(solver.summary().refused),
        excesses_seen(solver.summary().exceeding) {
    refusals.skip(board.reader);
    refused.items.reserve(ipc::kRefusalsKept);
  }
};

}  // namespace

struct Solver::Impl {
  std::string stream;
  SolverOptions options;
  ipc::OwnerLock lock;
  std::unique_ptr<Attachment> attachment;
  Time next_attach = Time::min();

  Impl(std::string name, const SolverOptions& how)
      : stream(std::move(name)),
        options((ipc::require_options(how), how)),
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
  if (!ipc::region_exists(impl_->stream, ipc::RegionKind::waypoints)) return false;
  try {
    auto [region, header, layout] = ipc::open_ring(impl_->stream, false, impl_->options.trust);
    ipc::require_same_clock(header, impl_->stream);
    RingView ring(std::move(region), header, layout);
    if (ring.ring.retired()) return false;
    auto board = own_board(impl_->stream, header, impl_->options, clock);
    if (const auto* const occupied = std::get_if<Occupied>(&board)) {
      impl_->next_attach = occupied->until;
      return false;
    }
    impl_->attachment =
        std::make_unique<Attachment>(std::move(ring), std::get<OwnedBoard>(std::move(board)));
    impl_->lock.keep_file();
  } catch (const NoSuchStream&) {
    return false;  // removed between the check and the opening
  }
  return true;
}

bool Solver::attached() const noexcept { return impl_->attachment != nullptr; }

StepResult Solver::step(const Clock& clock) {
  if (!attached()) return {};
  Attachment& at = *impl_->attachment;
  const StepResult result = at.solver.step(clock);
  if (result.damaged) {
    throw BadRegion(ipc::region_path(impl_->stream, ipc::RegionKind::spline) +
                    " holds data that its solver did not write");
  }
  if (result.published && impl_->options.wake) {
    ipc::wake_some(at.board.writer.revision_word());
    (void)at.board.lock.hold();
  }
  if (result.consumed == 0 && !result.missed && at.ring.ring.retired()) impl_->attachment.reset();
  return result;
}

Time Solver::due() const noexcept {
  if (attached()) return impl_->attachment->solver.due();
  return impl_->next_attach > Time::min() ? impl_->next_attach : Time::max();
}

void Solver::wait(Time timeout) noexcept {
  if (!attached()) {
    std::this_thread::sleep_for(std::min(timeout, kPoll));
    return;
  }
  Attachment& at = *impl_->attachment;
  (void)at.board.lock.hold();
  if (timeout <= Time::zero()) return;
  // The store and the load are seq_cst, as are the producer's store of its written position and its
  // load of sleeping: either this load sees the new position, or the producer sees that this solver
  // must be woken.
  at.board.writer.store_sleeping(true);
  const ipc::Word written = at.ring.ring.written(std::memory_order_seq_cst);
  const Time due = at.solver.due();
  const Time now = due < Time::max() ? MonotonicClock().now() : Time::zero();
  if (written == at.solver.seen() && due > now && !at.ring.ring.retired()) {
    ipc::wait_while_equal(at.ring.ring.written_word(), written,
                          std::min({timeout, kSlice, due - now}));
  }
  at.board.writer.store_sleeping(false);
}

void Solver::take_first_refusals(std::vector<ItemRefusal>& out) {
  out.clear();
  if (!attached()) return;
  Attachment& at = *impl_->attachment;
  if (at.solver.summary().refused == at.refusals_seen) return;
  at.refusals_seen = at.solver.summary().refused;
  at.refusals.look(at.board.reader, at.ring.ring, at.refused);
  for (const ItemRefusal& refusal : at.refused.items) {
    bool& told = at.told[static_cast<std::size_t>(refusal.reason) % at.told.size()];
    if (!told) out.push_back(refusal);
    told = true;
  }
}

std::optional<LimitExcess> Solver::take_first_excess() noexcept {
  if (!attached() || impl_->attachment->is_excess_told) return std::nullopt;
  Attachment& at = *impl_->attachment;
  const ipc::Summary& summary = at.solver.summary();
  while (at.excesses_seen < summary.exceeding) {
    const auto excess = at.board.reader.excess(summary, at.excesses_seen++);
    at.is_excess_told = excess && !excess->is_refused;
    if (at.is_excess_told) return excess;
  }
  return std::nullopt;
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

const ipc::RegionHeader& ipc::Internals::board(const Solver& solver) noexcept {
  return solver.impl_->attachment->board.header;
}

bool ipc::Internals::hold_region(Solver& solver) noexcept {
  return !solver.attached() || solver.impl_->attachment->board.lock.hold();
}

void ipc::Internals::prefetch(const Solver& solver, Stage stage) noexcept {
  if (stage == Stage::self) return ipc::prefetch_lines(solver.impl_.get(), sizeof(Solver::Impl));
  if (!solver.attached()) return;
  const Attachment& at = *solver.impl_->attachment;
  if (stage == Stage::parts) {
    ipc::prefetch_lines(&at.ring.ring, sizeof(at.ring.ring));
    ipc::prefetch_lines(&at.board.writer, sizeof(at.board.writer));
    ipc::prefetch_lines(&at.board.reader, sizeof(at.board.reader));
    ipc::prefetch_lines(&at.solver, sizeof(at.solver));
  } else {
    at.solver.prefetch();
  }
}

ipc::SolverWatch ipc::Internals::watch(const Solver& solver) noexcept {
  const Attachment& at = *solver.impl_->attachment;
  return {at.ring.ring.polled(), at.solver.seen(), at.solver.due(), at.solver.settled_raise()};
}

}  // namespace ipc
}  // namespace splinecast
