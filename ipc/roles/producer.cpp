#include "splinecast/producer.hpp"

#include <bit>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "ipc/board/knot_board.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/roles/stream_files.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// A wait is cut into slices: it watches the commit word, and the tail that it waits for is stored
/// only after that, so that a wake can be missed; and a solver may die before it wakes.
constexpr core::Time kSlice = std::chrono::milliseconds(1);
constexpr core::Time kPoll = std::chrono::milliseconds(2);

/// The solver's region as the producer sees it: where the ring's tail comes from.
struct SolverView {
  Region region;
  RegionHeader header;
  KnotBoardReader board;
  std::unique_ptr<ReplacementPlanner> planner;  ///< once a replacement has been previewed

  SolverView(Region mapped, const RegionHeader& described, const BoardLayout& layout)
      : region(std::move(mapped)), header(described), board(region.bytes(), layout) {
    region.close_descriptor();
  }
};

/// A ring region, made or taken over, and its writer.
struct OwnedRing {
  Region region;
  RegionLock lock;
  RegionHeader header;
  RingLayout layout;
  WaypointRingWriter writer;

  OwnedRing(Region mapped, const RegionHeader& described, const RingLayout& of_it)
      : region(std::move(mapped)),
        lock(region.descriptor()),
        header(described),
        layout(of_it),
        writer(region.bytes(), of_it, ingest_limits(described)) {}
};

OwnedRing make_ring(const std::string& stream, const ProducerOptions& options) {
  if (options.capacity < 2 || options.capacity > kMaxRingCapacity) {
    throw BadRequest("a ring has 2 to " + std::to_string(kMaxRingCapacity) + " items, not " +
                     std::to_string(options.capacity));
  }
  RegionHeader header = make_header(options, random_id());
  header.kind = static_cast<std::uint64_t>(RegionKind::waypoints);
  header.capacity = std::bit_ceil(options.capacity);
  const auto layout = RingLayout::of(header.dimensions, header.capacity, header.control);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  Region region = Region::create(layout.bytes, options.access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedRing ring(std::move(region), header, layout);
  if (!ring.region.link(stream, RegionKind::waypoints)) {
    throw BadRegion(region_path(stream, RegionKind::waypoints) + " came to be while it was made");
  }
  return ring;
}

void require_no_contradiction(const std::string& stream, const RegionHeader& stands,
                              const ProducerOptions& options) {
  const auto contradict = [&](const std::string& what) {
    throw BadRequest("stream '" + stream + "' was left unfinished by its producer and has " + what +
                     "; 'splinecast rm " + stream +
                     "' removes it, once its solver has been stopped");
  };
  const RegionHeader wanted = make_header(options, stands.stream_id);
  if (wanted.dimensions != stands.dimensions) {
    contradict(std::to_string(stands.dimensions) + " dimensions, not " +
               std::to_string(wanted.dimensions));
  }
  if (wanted.clock != stands.clock) contradict("another clock");
  if (start_condition(wanted) != start_condition(stands)) {
    contradict("start condition " + to_string(start_condition(stands)) + ", not " +
               to_string(options.start));
  }
  if (dimensions_of(wanted) != dimensions_of(stands)) contradict("other dimension kinds");
  if (wanted.name != stands.name) contradict("other dimension names");
  if (wanted.unit != stands.unit) contradict("other units");
  if (wanted.min_interval != stands.min_interval || wanted.max_interval != stands.max_interval) {
    contradict("other interval limits");
  }
}

/// Takes over the ring that stands under the name, if it is one to be continued; retires it if it
/// is finished.
std::optional<OwnedRing> continue_ring(const std::string& stream, const ProducerOptions& options) {
  if (!region_exists(stream, RegionKind::waypoints)) return std::nullopt;
  auto [region, header, layout] = open_ring(stream, true, options.trust);
  OwnedRing ring(std::move(region), header, layout);
  const WaypointRingReader past(ring.region.bytes(), layout);
  if (past.retired() || ring.writer.finished()) {
    ring.writer.retire();
    wake_all(ring.writer.head_word());
    unlink_region(stream, RegionKind::waypoints);
    return std::nullopt;
  }
  require_same_clock(header, stream);
  require_no_contradiction(stream, header, options);
  enter_owner(ring.region.bytes(), header);
  return ring;
}

OwnedRing own_ring(const std::string& stream, const ProducerOptions& options, OwnerLock& lock) {
  try {
    auto continued = continue_ring(stream, options);
    return continued ? std::move(*continued) : make_ring(stream, options);
  } catch (...) {
    lock.remove_litter();
    throw;
  }
}

}  // namespace

struct Producer::Impl {
  std::string stream;
  ProducerOptions options;
  OwnerLock lock;
  OwnedRing ring;
  bool continues;
  std::optional<SolverView> solver;
  WaypointRingReader sent;
  RefusalReader refused;
  core::Time settled_until = core::Time::min();
  MonotonicClock clock;

  Impl(std::string name, ProducerOptions how)
      : stream(std::move(name)),
        options(std::move(how)),
        lock(stream, RegionKind::waypoints),
        ring(own_ring(stream, options, lock)),
        continues(ring.writer.head() > 0),
        sent(ring.region.bytes(), ring.layout),
        refused(ring.writer.head()) {
    if (continues) look_for_solver();
    if (solver) refused.skip(solver->board);
  }

  /// Looks for the solver's region until there is one for this very stream.
  void look_for_solver() noexcept {
    if (solver && !solver->board.retired()) return;
    solver.reset();
    try {
      // The id first: mapping a large board of an earlier stream each time would be costly.
      const auto peeked = peek_header(stream, RegionKind::spline, options.trust);
      if (!peeked || peeked->stream_id != ring.header.stream_id) return;
      auto [region, header, layout] = open_board(stream, false, options.trust);
      if (header.stream_id != ring.header.stream_id) return;
      solver.emplace(std::move(region), header, layout);
      refused.restart();
    } catch (const std::exception&) {
      solver.reset();  // not there yet, or not ours: looked for again
    }
  }

  [[nodiscard]] Word consumed() const noexcept { return solver ? solver->board.tail() : 0; }

  /// What is known of the solver.
  [[nodiscard]] WaypointRingWriter::Solved solved() noexcept {
    if (!solver) look_for_solver();
    WaypointRingWriter::Solved known{.consumed = consumed()};
    if (stream_clock(ring.header) == StreamClock::recorded) return known;
    known.clock = &clock;
    if (!solver) return known;
    const Look look = solver->board.look();
    const bool is_time = core::is_time_in_range(look.settled_until);
    if (look.revision > 0 && is_time) settled_until = look.settled_until;
    known.settled_until = settled_until;
    return known;
  }

  AppendStatus appended(AppendStatus status) noexcept {
    // Again after the store: a solver that came meanwhile may already sleep.
    if (!solver) look_for_solver();
    if (status == AppendStatus::accepted && solver && solver->board.sleeping()) {
      wake_all(ring.writer.head_word());
      (void)ring.lock.hold();
    }
    return status;
  }

  /// Waits until `done()`, or for the timeout, with the solver's revision as the word to watch.
  template <typename Done>
  bool wait(core::Time timeout, const Done& done) {
    const core::Time end = deadline(clock, timeout);
    for (;;) {
      look_for_solver();
      (void)ring.lock.hold();
      const Word seen = solver ? solver->board.revision() : 0;
      if (done()) return true;
      const core::Time left = end - clock.now();
      if (left <= core::Time::zero()) return false;
      if (solver) {
        (void)wait_for_change(solver->board.revision_word(), seen, std::min(left, kSlice));
      } else {
        std::this_thread::sleep_for(std::min(left, kPoll));
      }
    }
  }
};

Producer::Producer(std::string stream, ProducerOptions options)
    : impl_(std::make_unique<Impl>(std::move(stream), std::move(options))) {}
Producer::Producer(Producer&&) noexcept = default;
Producer& Producer::operator=(Producer&&) noexcept = default;
Producer::~Producer() = default;

AppendStatus Producer::append(const core::Waypoint& waypoint) noexcept {
  return impl_->appended(impl_->ring.writer.append(waypoint, impl_->solved()));
}

AppendStatus Producer::replace_from(core::Time t, std::span<const core::Waypoint> waypoints,
                                    const ReplaceOptions& options) noexcept {
  return impl_->appended(
      impl_->ring.writer.replace_from(t, waypoints, impl_->solved(), options.blend));
}

ReplacePreview Producer::preview_replace(core::Time t, std::span<const core::Waypoint> waypoints,
                                         const ReplaceOptions& options) {
  ReplacePreview preview;
  preview_replace(t, waypoints, options, preview);
  return preview;
}

void Producer::preview_replace(core::Time t, std::span<const core::Waypoint> waypoints,
                               const ReplaceOptions& options, ReplacePreview& out) {
  const auto known = impl_->solved();
  out.status = impl_->ring.writer.check_replacement(t, waypoints, known, options.blend);
  out.is_known = false;
  if (out.status != AppendStatus::accepted || !impl_->solver) return;
  SolverView& solver = *impl_->solver;
  if (!solver.planner) {
    solver.planner = std::make_unique<ReplacementPlanner>(
        solver.board, window_options(solver.header), dimension_kinds(solver.header),
        live_options(solver.header));
  }
  const core::Time from = waypoints.empty() ? std::max(t, known.settled_until) : t;
  solver.planner->plan(from, waypoints, options.blend, out);
}

AppendStatus Producer::start_from(const core::Instant& state) noexcept {
  return impl_->appended(impl_->ring.writer.start_from(state, impl_->solved()));
}

core::Time Producer::earliest() noexcept { return impl_->solved().settled_until; }

AppendStatus Producer::finish(const core::Condition& end) {
  core::require_values(end, impl_->ring.header.dimensions);
  dimension_kinds(impl_->ring.header).require_end(end);
  if (!core::is_online(end.kind)) {
    throw BadRequest("end condition '" + core::to_string(end) +
                     "' needs all waypoints at once: a stream cannot meet it");
  }
  if (stream_clock(impl_->ring.header) == StreamClock::monotonic && !core::is_at_rest(end.kind)) {
    throw BadRequest("end condition '" + core::to_string(end) +
                     "' is not at rest: a live stream ends with rest or halt");
  }
  return impl_->appended(impl_->ring.writer.finish(end, impl_->solved()));
}

Refusals Producer::refusals() {
  Refusals found;
  refusals(found);
  return found;
}

void Producer::refusals(Refusals& out) {
  impl_->look_for_solver();
  if (impl_->solver) {
    impl_->refused.look(impl_->solver->board, impl_->sent, out);
  } else {
    out.items.clear();
    out.missed = out.consumed = 0;
  }
}

bool Producer::wait_for_solver(core::Time timeout) {
  return impl_->wait(timeout, [this] { return impl_->solver && solver_alive(); });
}

bool Producer::wait_for_room(core::Time timeout) {
  return impl_->wait(timeout, [this] {
    const Word waiting = impl_->ring.writer.head() - impl_->consumed();
    const std::size_t capacity = impl_->ring.header.capacity;
    return waiting + control_reserve(capacity) < capacity;
  });
}

bool Producer::wait_until_consumed(core::Time timeout) {
  return impl_->wait(timeout, [this] { return impl_->consumed() == impl_->ring.writer.head(); });
}

bool Producer::solver_alive() const {
  try {
    return owner_lives(impl_->stream, RegionKind::spline);
  } catch (const OutOfResources&) {
    return true;
  }
}

Word Producer::appended() const noexcept { return impl_->ring.writer.head(); }
Word Producer::consumed() const noexcept { return impl_->consumed(); }
std::uint64_t Producer::stream_id() const noexcept { return impl_->ring.header.stream_id; }
bool Producer::continues() const noexcept { return impl_->continues; }
core::Time Producer::last_time() const noexcept { return impl_->ring.writer.last_time(); }
bool Producer::is_memory_locked() const noexcept { return impl_->ring.region.is_memory_locked(); }

void Producer::withdraw() noexcept {
  impl_->ring.writer.retire();
  wake_all(impl_->ring.writer.head_word());
  unlink_region(impl_->stream, RegionKind::waypoints);
  impl_->lock.remove_file();
}

}  // namespace splinecast::ipc
