#include "splinecast/producer.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "ipc/board/named_board.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/continued_motion.hpp"
#include "ipc/owned/outcome.hpp"
#include "ipc/owned/ring.hpp"
#include "ipc/owned/stoppers.hpp"
#include "ipc/owned/stream_start.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/roles/refusals.hpp"
#include "ipc/roles/replace_preview.hpp"
#include "ipc/runs/run_edges.hpp"
#include "splinecast/errors.hpp"

namespace splinecast {
namespace {

/// Maximum length of one futex wait. A wake can be missed: the futex word is the commit word, and
/// the consumed position that the producer waits for is stored only after it. Also, a solver may
/// die before it wakes the producer.
constexpr Time kSlice = std::chrono::milliseconds(1);
constexpr Time kPoll = std::chrono::milliseconds(2);

/// A solver that sleeps takes some tens of microseconds to wake.
constexpr Time kLeastPause = std::chrono::microseconds(200);

const MonotonicClock kClock;

}  // namespace

struct Producer::Impl {
  std::string stream;
  ProducerOptions options;
  ipc::OwnerLock lock;
  ipc::RegionHeader of_law;  ///< of the law that the stream follows; stream_id 0: none
  ipc::OwnedRing ring;
  bool continues;
  bool is_first;  ///< no waypoint has been appended to a ring that is continued
  std::optional<ipc::BoardView> solver;              ///< the board of the solver
  std::unique_ptr<ipc::ReplacementPlanner> planner;  ///< once a replacement has been previewed
  ipc::WaypointRingReader sent;
  ipc::RefusalReader refused;
  ipc::StreamStart start;
  Time settled_until = Time::min();
  std::optional<ipc::Word> replacement;  ///< the item of the last one
  ipc::Word last_item = 0;               ///< of the last accepted call
  const Clock* clock;
  std::unique_ptr<ipc::LawFollower> law;
  std::unique_ptr<ipc::LawClock> law_clock;

  Impl(std::string name, ProducerOptions how, const Clock& time)
      : stream(std::move(name)),
        options(std::move(how)),
        lock((ipc::require_stream_name(stream), stream), ipc::RegionKind::waypoints),
        of_law(header_of_law()),
        ring(ipc::own_ring(stream, options, lock,
                           [this](ipc::RegionHeader& header) { ipc::put_law(of_law, header); })),
        continues(ring.writer.written() > 0),
        is_first(continues),
        sent(ring.region.bytes(), ring.layout),
        refused(ring.writer.written()),
        start(stream, ring, options),
        clock(&time) {
    if (ring.header.law_id != 0) {
      law = std::make_unique<ipc::LawFollower>(ring.header, options.trust);
      law_clock = std::make_unique<ipc::LawClock>(*law, *clock);
    }
    if (continues) find_solver();
    if (solver) refused.skip(solver->reader);
  }

  /// The header of the law that the options name; one with the stream id 0 if they name none.
  [[nodiscard]] ipc::RegionHeader header_of_law() {  // own_ring refuses a law without this clock
    if (options.law.empty() || options.clock != StreamClock::law) return {};
    try {
      return ipc::header_of_law(options.law, options.trust);
    } catch (...) {
      lock.remove_unused_file();
      throw;
    }
  }

  /// The clock of a live stream's times.
  [[nodiscard]] const Clock& stream_clock() const noexcept {
    return law_clock ? static_cast<const Clock&>(*law_clock) : *clock;
  }

  /// Opens the solver's region of this stream, unless it is already open. Closes a retired one.
  /// Leaves `solver` empty if there is no usable region.
  void find_solver() noexcept {
    if (solver && !solver->reader.retired()) return;
    planner.reset();
    solver.reset();
    try {
      // Checks the id first: mapping a large board of an earlier stream each time would be costly.
      const auto peeked = ipc::peek_header(stream, ipc::RegionKind::spline, options.trust);
      if (!peeked || peeked->stream_id != ring.header.stream_id) return;
      auto opened = ipc::open_board(stream, false, options.trust);
      if (opened.header.stream_id != ring.header.stream_id) return;
      solver.emplace(std::move(opened));
      refused.restart();
    } catch (const std::exception&) {
      solver.reset();  // missing, or not usable: retried later
    }
  }

  [[nodiscard]] ipc::Word consumed() const noexcept {
    return solver ? solver->reader.consumed() : 0;
  }

  /// What is known of the solver's state. If its region is not open, tries to open it.
  [[nodiscard]] ipc::WaypointRingWriter::Solved read_solver() noexcept {
    if (!solver) find_solver();
    ipc::WaypointRingWriter::Solved known{.consumed = consumed()};
    if (ipc::stream_clock(ring.header) == StreamClock::recorded) return known;
    known.clock = &stream_clock();
    if (!law && options.horizon < Time::max()) known.horizon = options.horizon;
    if (!solver) return known;
    known.settle_ahead = Time(solver->header.freeze_ahead);
    const ipc::Look look = solver->reader.look();
    const bool is_time = is_time_in_range(look.settled_until);
    if (look.revision > 0 && is_time) settled_until = look.settled_until;
    known.settled_until = settled_until;
    known.is_stopped = solver->reader.holders() > 0;
    const bool may_refuse = ipc::beyond(solver->header) == Beyond::enter && look.revision > 0;
    if (may_refuse) known.refused_until = solver->reader.refused_until(look.revision);
    return known;
  }

  /// What a producer adds to the earliest time of a replacement, so that the solver finds it in
  /// time: the solver's longest pause. At rest a solver commits nothing and wakes at once.
  [[nodiscard]] Time longest_pause() const noexcept {
    constexpr Time kLastSecond = std::chrono::seconds(1);
    ipc::Summary summary;
    const bool is_known = solver && solver->reader.copy_newest_summary(summary) &&
                          stream_clock().now() - summary.committed < kLastSecond;
    return is_known ? std::max(summary.longest_pause, kLeastPause) : kLeastPause;
  }

  /// The header of the solver's board; null until a solver has attached.
  [[nodiscard]] const ipc::RegionHeader* board_header() const noexcept {
    return solver ? &solver->header : nullptr;
  }

  AppendStatus append(const Waypoint& waypoint) noexcept {
    const auto known = read_solver();
    if (start.is_open()) return start.append(waypoint, ring.writer, known, board_header());
    const bool has_curve = known.clock != nullptr && solver && known.settled_until > Time::min();
    const ipc::Word item = ring.writer.written();
    const AppendStatus status =
        is_first && has_curve ? append_first(waypoint, known) : ring.writer.append(waypoint, known);
    is_first = is_first && status != AppendStatus::accepted;
    if (ring.writer.written() > item + 1) replacement = item;
    return status;
  }

  AppendStatus append_first(const Waypoint& waypoint,
                            const ipc::WaypointRingWriter::Solved& known) noexcept {
    try {
      ipc::ContinuedMotion motion(sent, solver->reader, solver->header);
      return motion.append(waypoint, ring.writer, known);
    } catch (const std::bad_alloc&) {
      return ipc::replace_motion(waypoint, ring.writer, known);
    }
  }

  AppendStatus replace_from(Time t, const ipc::ReplacementPath& path, Time blend) noexcept {
    const auto known = read_solver();
    const bool begins = start.is_open();
    const AppendStatus status = wake_solver_for(
        begins ? start.replace_from(t, path, blend, ring.writer, known, board_header())
               : ring.writer.replace_from(t, path, known, blend),
        1 + path.size());
    is_first = is_first && (begins || status != AppendStatus::accepted);
    if (status == AppendStatus::accepted) replacement = last_item;
    return status;
  }

  /// Wakes the solver if a call with this number of items, which are the newest ones in the ring,
  /// was accepted. Returns the status.
  AppendStatus wake_solver_for(AppendStatus status, ipc::Word items = 1) noexcept {
    const ipc::Word end = ring.writer.written();
    if (status == AppendStatus::accepted && end >= items) last_item = end - items;
    // Looks again after the store: a solver that attached meanwhile may already sleep.
    if (!solver) find_solver();
    if (status == AppendStatus::accepted && solver && solver->reader.sleeping()) {
      ipc::wake_all(ring.writer.written_word());
      (void)ring.lock.hold();
    }
    return status;
  }

  /// Waits until `done()` is true or the timeout expires; returns done(). The futex word is the
  /// solver's revision.
  template <typename Done>
  bool wait(Time timeout, const Done& done) {
    const Time end = deadline(kClock, timeout);
    for (;;) {
      find_solver();
      (void)ring.lock.hold();
      const ipc::Word seen = solver ? solver->reader.revision() : 0;
      if (done()) return true;
      const Time left = end - kClock.now();
      if (left <= Time::zero()) return false;
      if (solver) {
        (void)ipc::wait_for_change(solver->reader.revision_word(), seen, std::min(left, kSlice));
      } else {
        std::this_thread::sleep_for(std::min(left, kPoll));
      }
    }
  }
};

Producer::Producer(std::string stream, ProducerOptions options)
    : Producer(std::make_unique<Impl>(std::move(stream), std::move(options), kClock)) {}
Producer::Producer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Producer::Producer(Producer&&) noexcept = default;
Producer& Producer::operator=(Producer&&) noexcept = default;
Producer::~Producer() = default;

AppendStatus Producer::append(const Waypoint& waypoint) noexcept {
  return impl_->wake_solver_for(impl_->append(waypoint));
}

AppendStatus Producer::replace_from(Time t, std::span<const Waypoint> waypoints,
                                    const ReplaceOptions& options) noexcept {
  return impl_->replace_from(t, waypoints, options.blend);
}

AppendStatus Producer::replace_by_columns(Time t, const Waypoints& columns, Time blend) noexcept {
  return impl_->replace_from(t, columns, blend);
}

ReplacePreview Producer::preview_replace(Time t, std::span<const Waypoint> waypoints,
                                         const ReplaceOptions& options) {
  ReplacePreview preview;
  preview_replace(t, waypoints, options, preview);
  return preview;
}

void Producer::preview_replace(Time t, std::span<const Waypoint> waypoints,
                               const ReplaceOptions& options, ReplacePreview& out) {
  const auto known = impl_->read_solver();
  out.status = impl_->ring.writer.check_replacement(t, waypoints, known, options.blend);
  out.is_known = false;
  if (out.status != AppendStatus::accepted || !impl_->solver) return;
  const ipc::BoardView& solver = *impl_->solver;
  if (!impl_->planner) {
    impl_->planner = std::make_unique<ipc::ReplacementPlanner>(
        solver.reader, ipc::window_options(solver.header), ipc::dimension_kinds(solver.header),
        ipc::live_options(solver.header), ipc::beyond(solver.header));
  }
  out.begin = std::max(t, ipc::WaypointRingWriter::earliest_replacement(known));
  out.from_rest = false;
  if (const auto held = known.clock != nullptr ? known.clock->held() : std::nullopt) {
    const Time rest = *held + Time(1);
    out.from_rest = ipc::begins_at_rest(t, rest, known.settled_until, known.settle_ahead);
    if (out.from_rest) out.begin = rest;
  }
  impl_->planner->plan(waypoints, options.blend, out);
}

std::optional<ReplacementBegin> Producer::replacement_begin() {
  impl_->find_solver();
  if (!impl_->replacement || impl_->consumed() <= *impl_->replacement) return std::nullopt;
  return ipc::begin_of_run(impl_->solver->reader, *impl_->replacement);
}

AppendStatus Producer::start_from(const Instant& state, const StartOptions& options) noexcept {
  return impl_->wake_solver_for(
      impl_->start.start_from(state, options, impl_->ring.writer, impl_->read_solver()));
}

Instant Producer::old_end() noexcept {
  if (!impl_->start.is_open() || !impl_->start.look()) return {};
  return impl_->start.state(impl_->read_solver());
}

std::string Producer::why_elsewhere(const Waypoint& first) {
  if (!impl_->start.is_open()) return {};
  return impl_->start.why_elsewhere(first, impl_->read_solver(), impl_->board_header());
}

std::vector<std::string> Producer::stopped_by() {
  impl_->find_solver();
  return impl_->solver ? ipc::holders_of(impl_->solver->reader) : std::vector<std::string>{};
}

Time Producer::now() noexcept {
  const bool is_recorded = ipc::stream_clock(impl_->ring.header) == StreamClock::recorded;
  return is_recorded ? Time::zero() : impl_->stream_clock().now();
}

Time Producer::earliest() noexcept {
  const auto known = impl_->read_solver();
  const Time earliest = ipc::WaypointRingWriter::earliest_replacement(known);
  // What a law holds begins at rest where it holds it, at once.
  const bool is_exact = known.clock == nullptr || known.clock->held();
  return is_exact ? earliest : earliest + impl_->longest_pause();
}

AppendStatus Producer::finish(const Condition& end) {
  ipc::require_usable("end", end, impl_->ring.header.dimensions);
  try {
    ipc::dimension_kinds(impl_->ring.header).require_end(end);
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
  if (is_live(ipc::stream_clock(impl_->ring.header)) && !is_at_rest(end.kind)) {
    throw BadRequest("end condition '" + to_string(end) +
                     "' is not at rest: a live stream ends with clamped or halt");
  }
  return impl_->wake_solver_for(impl_->ring.writer.finish(end, impl_->read_solver()));
}

Refusals Producer::refusals() {
  Refusals found;
  return refusals(found), found;
}

void Producer::refusals(Refusals& out) {
  impl_->find_solver();
  out.items.clear();
  out.missed = out.consumed = 0;
  if (impl_->solver) impl_->refused.look(impl_->solver->reader, impl_->sent, out);
}

std::uint64_t Producer::last_item() const noexcept { return impl_->last_item; }

ItemOutcome Producer::outcome(std::uint64_t item) noexcept {
  impl_->find_solver();
  return impl_->solver ? ipc::outcome_of(impl_->solver->reader, impl_->sent, item) : ItemOutcome{};
}

ItemOutcome Producer::wait_outcome(std::uint64_t item, Time timeout) {
  ItemOutcome found;
  (void)impl_->wait(timeout, [&] { return is_known(found = outcome(item)); });
  return found;
}

bool Producer::wait_for_solver(Time timeout) {
  return impl_->wait(timeout, [this] { return impl_->solver && solver_alive(); });
}

bool Producer::wait_for_room(Time timeout) {
  return impl_->wait(timeout, [this] {
    const ipc::Word waiting = impl_->ring.writer.written() - impl_->consumed();
    const std::size_t capacity = impl_->ring.header.capacity;
    return waiting + ipc::control_reserve(capacity) < capacity;
  });
}

bool Producer::wait_until_consumed(Time timeout) {
  return impl_->wait(timeout, [this] { return impl_->consumed() == impl_->ring.writer.written(); });
}

bool Producer::solver_alive() const {
  try {
    return ipc::owner_lives(impl_->stream, ipc::RegionKind::spline);
  } catch (const OutOfResources&) {
    return true;
  }
}

ipc::Word Producer::appended() const noexcept { return impl_->ring.writer.written(); }
ipc::Word Producer::consumed() const noexcept { return impl_->consumed(); }
std::uint64_t Producer::stream_id() const noexcept { return impl_->ring.header.stream_id; }
bool Producer::continues() const noexcept { return impl_->continues; }
Time Producer::last_time() const noexcept { return impl_->ring.writer.last_time(); }
bool Producer::is_memory_locked() const noexcept { return impl_->ring.region.is_memory_locked(); }

void Producer::withdraw() noexcept {
  impl_->ring.writer.retire();
  ipc::wake_all(impl_->ring.writer.written_word());
  ipc::unlink_region(impl_->stream, ipc::RegionKind::waypoints);
  impl_->lock.remove_file();
}

Producer ipc::Internals::producer(std::string stream, ProducerOptions options, const Clock& clock) {
  return Producer(std::make_unique<Producer::Impl>(std::move(stream), std::move(options), clock));
}

}  // namespace splinecast
