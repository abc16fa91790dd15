#include "splinecast/solver.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <limits>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "core/forms/stop.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/roles/old_motion.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::size_t kDefaultCapacity = 4096;
constexpr core::Time kDefaultStopTime = std::chrono::milliseconds(250);
/// Longest that anything settles ahead, or is kept: a minute and a day are out of all proportion.
constexpr core::Time kLongestFreeze = std::chrono::minutes(1);
constexpr core::Time kLongestHistory = std::chrono::hours(24);
/// Longest sleep: retiring a ring does not move the word slept on, so its wake can be missed.
constexpr core::Time kSlice = std::chrono::milliseconds(50);
/// How often a solver without a stream looks for one.
constexpr core::Time kPoll = std::chrono::milliseconds(5);

template <typename T>
void require_same(const std::string& stream, const char* what, const std::optional<T>& wanted,
                  const T& stands, const std::string& wanted_text, const std::string& stands_text) {
  if (!wanted || *wanted == stands) return;
  throw BadRequest("stream '" + stream + "' is solved with " + what + ' ' + stands_text + ", not " +
                   wanted_text + "; 'splinecast rm " + stream + "' removes it");
}

const core::Method& method_of(const SolverOptions& options) {
  return options.method == nullptr ? core::c2() : *options.method;
}

/// Limits that are asked for must be those of the board; a kind of which none is given may be any.
void require_same_limits(const std::string& stream, const RegionHeader& stands,
                         const SolverOptions& options) {
  const core::MotionLimits limits = limits_for(options, stands);
  const core::MotionLimits stood = motion_limits(stands);
  const auto compare = [&](const char* what, const std::vector<double>& wanted,
                           const std::vector<double>& there, double none) {
    const auto at = [none](const std::vector<double>& values, std::size_t d) {
      return values.empty() ? none : values[d];
    };
    const auto text = [none](double value) {
      return value == none ? std::string("none") : std::to_string(value);
    };
    for (std::size_t d = 0; d < wanted.size(); ++d) {
      require_same(stream, what, std::optional(wanted[d]), at(there, d), text(wanted[d]),
                   text(at(there, d)));
    }
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  compare("velocity limit", limits.velocity, stood.velocity, 0);
  compare("acceleration limit", limits.acceleration, stood.acceleration, 0);
  compare("jerk limit", limits.jerk, stood.jerk, 0);
  compare("lower bound", limits.lower, stood.lower, -kInfinity);
  compare("upper bound", limits.upper, stood.upper, kInfinity);
}

void require_no_contradiction(const std::string& stream, const RegionHeader& stands,
                              const SolverOptions& options) {
  const auto number = [](auto value) { return std::to_string(value); };
  const core::Method* const method = core::find_method(stands.method);
  if (options.method != nullptr) {
    require_same<const core::Method*>(stream, "method", options.method, method,
                                      std::string(options.method->name), std::string(method->name));
  }
  require_same(stream, "lambda", options.lambda, stands.lambda, number(options.lambda.value_or(0)),
               number(stands.lambda));
  require_same(stream, "time scale", options.time_scale, stands.time_scale,
               number(options.time_scale.value_or(0)), number(stands.time_scale));
  require_same<std::size_t>(stream, "settle lag", options.settle, stands.settle,
                            number(options.settle.value_or(0)), number(stands.settle));
  const auto tail = static_cast<core::Tail>(stands.tail);
  require_same(stream, "tail", options.tail, tail,
               std::string(core::to_string(options.tail.value_or(tail))),
               std::string(core::to_string(tail)));
  const core::Time stop_time(stands.stop_time);
  require_same(stream, "stop time in ns", options.stop_time, stop_time,
               number(options.stop_time.value_or(stop_time).count()), number(stands.stop_time));
  const auto require_same_time = [&](const char* what, const std::optional<core::Time>& wanted,
                                     std::int64_t stood) {
    require_same(stream, what, wanted, core::Time(stood),
                 number(wanted.value_or(core::Time(stood)).count()), number(stood));
  };
  require_same_time("freeze-ahead in ns", options.freeze_ahead, stands.freeze_ahead);
  require_same_time("history in ns", options.history, stands.history);
  require_same_time("shortest splice in ns", options.min_splice, stands.min_splice);
  require_same_limits(stream, stands, options);
  if (options.beyond) {
    require_same<std::uint64_t>(stream, "what is done beyond limits (0 report, 1 refuse)",
                                static_cast<std::uint64_t>(*options.beyond), stands.beyond,
                                number(static_cast<int>(*options.beyond)), number(stands.beyond));
  }
  if (options.capacity) {
    require_same<std::size_t>(stream, "capacity", std::bit_ceil(*options.capacity), stands.capacity,
                              number(*options.capacity), number(stands.capacity));
  }
}

/// The options of a new board: what is unset takes its default.
void write_options(const SolverOptions& options, RegionHeader& header) {
  const core::Method& method = method_of(options);
  header.method = method.number;
  header.lambda = options.lambda.value_or(0.0);
  header.time_scale = options.time_scale.value_or(1.0);
  header.settle = options.settle.value_or(core::default_settle(method));
  header.tail = static_cast<std::uint64_t>(options.tail.value_or(core::Tail::bessel));
  const core::MotionLimits limits = limits_for(options, header);
  header.stop_time = options.stop_time.value_or(kDefaultStopTime).count();
  put_limits(limits, header);
  header.beyond = static_cast<std::uint64_t>(options.beyond.value_or(core::Beyond::report));
  const LiveOptions live;
  const core::Time freeze_ahead = options.freeze_ahead.value_or(live.freeze_ahead);
  header.freeze_ahead = freeze_ahead.count();
  header.history = options.history.value_or(live.history).count();
  header.min_splice = options.min_splice.value_or(freeze_ahead).count();
  header.force_lag = options.force_lag ? 1 : 0;
  header.capacity = std::bit_ceil(options.capacity.value_or(kDefaultCapacity));
}

void require_time(const char* what, const std::optional<core::Time>& time, core::Time least,
                  core::Time most) {
  if (!time || (*time >= least && *time <= most)) return;
  throw BadRequest(std::string(what) + " must be " + std::to_string(least.count()) + " to " +
                   std::to_string(most.count()) + " ns, not " + std::to_string(time->count()));
}

void require_options(const SolverOptions& options) {
  if (options.stop_time &&
      (*options.stop_time <= core::Time::zero() || *options.stop_time > kLongestStop)) {
    throw BadRequest("stop time must be positive and at most 2^60 ns, not " +
                     std::to_string(options.stop_time->count()) + " ns");
  }
  require_time("freeze-ahead", options.freeze_ahead, core::Time(1), kLongestFreeze);
  require_time("history", options.history, core::Time::zero(), kLongestHistory);
  require_time("shortest splice", options.min_splice, core::Time(1), kLongestFreeze);
  const core::Method& method = method_of(options);
  if (method.family == core::Family::smoothing && !options.lambda) {
    throw BadRequest("method smoothing needs a lambda: online it cannot be chosen");
  }
  if (options.lambda && method.family != core::Family::smoothing) {
    throw BadRequest("lambda is for method smoothing, not for " + std::string(method.name));
  }
  if (options.force_lag && method.family != core::Family::smoothing) {
    throw BadRequest("a lag is forced for method smoothing only, not for " +
                     std::string(method.name));
  }
  if (options.time_scale && method.laws.is_scale_free) {
    throw BadRequest("the time scale is for method rounded, not for " + std::string(method.name));
  }
  if (options.tail && method.has_own_tail()) {
    throw BadRequest("method " + std::string(method.name) + " has a tail of its own, not '" +
                     std::string(core::to_string(*options.tail)) + "'");
  }
  // How many dimensions there will be is not known yet, nor their kinds.
  SolverOptions curve = options;
  curve.limits.reset();
  curve.named_limits.clear();
  RegionHeader header{};
  header.dimensions = 1;
  write_options(curve, header);
  try {
    if (options.limits) core::require_limits(*options.limits);
    (void)core::SlidingWindow(1, window_options(header));
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
  const std::size_t least = StreamSolver::min_capacity(header.settle);
  if (options.capacity && (*options.capacity < least || *options.capacity > kMaxBoardCapacity)) {
    throw BadRequest("capacity must be " + std::to_string(least) + " to " +
                     std::to_string(kMaxBoardCapacity) + " segments, not " +
                     std::to_string(*options.capacity));
  }
}

/// The producer's region, as the solver reads it.
struct RingView {
  Region region;
  RegionHeader header;
  WaypointRingReader ring;

  RingView(Region mapped, const RegionHeader& described, const RingLayout& layout)
      : region(std::move(mapped)), header(described), ring(region.bytes(), layout) {
    region.close_descriptor();
  }
};

/// The solver's own region, made or taken over.
struct OwnedBoard {
  Region region;
  RegionLock lock;
  RegionHeader header;
  bool taken_over;
  KnotBoardWriter writer;
  KnotBoardReader reader;

  OwnedBoard(Region mapped, const RegionHeader& described, const BoardLayout& layout, bool old)
      : region(std::move(mapped)),
        lock(region.descriptor()),
        header(described),
        taken_over(old),
        writer(region.bytes(), layout),
        reader(region.bytes(), layout) {}
};

OwnedBoard make_board(const std::string& stream, const RegionHeader& ring_header,
                      const SolverOptions& options) {
  RegionHeader header = ring_header;
  header.kind = static_cast<std::uint64_t>(RegionKind::spline);
  write_options(options, header);
  const auto layout =
      BoardLayout::of(header.dimensions, header.capacity, header.control, smooths(header));
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  header.epoch = 0;
  Region region = Region::create(layout.bytes, options.access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedBoard board(std::move(region), header, layout, false);
  if (!board.region.link(stream, RegionKind::spline)) {
    throw BadRegion(region_path(stream, RegionKind::spline) + " came to be while it was made");
  }
  return board;
}

/// The board of an earlier stream keeps the name until then.
struct Occupied {
  core::Time until;
};

std::variant<OwnedBoard, Occupied> own_board(const std::string& stream,
                                             const RegionHeader& ring_header,
                                             const SolverOptions& options, const Clock& clock) {
  if (!region_exists(stream, RegionKind::spline)) return make_board(stream, ring_header, options);
  auto [region, header, layout] = open_board(stream, true, options.trust);
  OwnedBoard board(std::move(region), header, layout, true);
  if (header.stream_id != ring_header.stream_id || board.reader.retired()) {
    // Readers follow the old curve to its end: they must not find another one in mid-motion.
    const core::Time end = end_of_motion(header, board.reader);
    const core::Time now = clock.now();
    require_near_end(stream, end, now);
    if (now < end) return Occupied{end};
    board.writer.retire();
    wake_all(board.writer.revision_word());
    unlink_region(stream, RegionKind::spline);
    return make_board(stream, ring_header, options);
  }
  require_same_stream(ring_header, header);
  require_no_contradiction(stream, header, options);
  enter_owner(board.region.bytes(), header);
  board.writer.store_sleeping(false);
  return board;
}

}  // namespace

/// What a solver has while a stream stands.
struct Attachment {
  RingView ring;
  OwnedBoard board;
  StreamSolver solver;
  RefusalReader refusals;
  Refusals refused;
  Word refusals_seen;
  Word excesses_seen;
  bool is_excess_told = false;
  std::array<bool, kRefusalReasons> told{};  ///< by Refusal

  Attachment(RingView producer, OwnedBoard own)
      : ring(std::move(producer)),
        board(std::move(own)),
        solver(ring.ring, board.writer, board.reader, window_options(board.header),
               ingest_limits(ring.header), dimension_kinds(ring.header), live_options(board.header),
               beyond(board.header)),
        refusals_seen(solver.head().refused),
        excesses_seen(solver.head().exceeding) {
    refusals.skip(board.reader);
    refused.items.reserve(kRefusalsKept);
  }
};

struct Solver::Impl {
  std::string stream;
  SolverOptions options;
  OwnerLock lock;
  std::unique_ptr<Attachment> attachment;
  core::Time next_attach = core::Time::min();

  Impl(std::string name, const SolverOptions& how)
      : stream(std::move(name)),
        options((require_options(how), how)),
        lock(stream, RegionKind::spline) {
    try {
      // Told now rather than when a producer comes: a board that cannot be taken over.
      if (region_exists(stream, RegionKind::spline)) (void)open_board(stream, true, options.trust);
    } catch (const StreamError&) {
      lock.remove_litter();
      throw;
    }
  }

  ~Impl() { lock.remove_litter(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

Solver::Solver(std::string stream, const SolverOptions& options)
    : impl_(std::make_unique<Impl>(std::move(stream), options)) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

void Solver::require(const SolverOptions& options) { require_options(options); }

bool Solver::attach() { return attach(MonotonicClock()); }

bool Solver::attach(const Clock& clock) {
  if (attached()) return true;
  if (impl_->next_attach > core::Time::min() && clock.now() < impl_->next_attach) return false;
  impl_->next_attach = core::Time::min();
  if (!region_exists(impl_->stream, RegionKind::waypoints)) return false;
  try {
    auto [region, header, layout] = open_ring(impl_->stream, false, impl_->options.trust);
    require_same_clock(header, impl_->stream);
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
    return false;  // it went between the look and the opening
  }
  return true;
}

bool Solver::attached() const noexcept { return impl_->attachment != nullptr; }

bool Solver::hold_region() noexcept { return !attached() || impl_->attachment->board.lock.hold(); }

StepResult Solver::step(const Clock& clock) {
  if (!attached()) return {};
  Attachment& at = *impl_->attachment;
  const StepResult result = at.solver.step(clock);
  if (result.damaged) {
    throw BadRegion(region_path(impl_->stream, RegionKind::spline) +
                    " holds what its solver has not written");
  }
  if (result.published && impl_->options.wake) {
    wake_some(at.board.writer.revision_word());
    (void)at.board.lock.hold();
  }
  if (result.consumed == 0 && !result.missed && at.ring.ring.retired()) impl_->attachment.reset();
  return result;
}

core::Time Solver::due() const noexcept {
  if (attached()) return impl_->attachment->solver.due();
  return impl_->next_attach > core::Time::min() ? impl_->next_attach : core::Time::max();
}

void Solver::wait(core::Time timeout) noexcept {
  if (!attached()) {
    std::this_thread::sleep_for(std::min(timeout, kPoll));
    return;
  }
  Attachment& at = *impl_->attachment;
  (void)at.board.lock.hold();
  if (timeout <= core::Time::zero()) return;
  // The store and the load are seq_cst, as are the producer's store of head and load of sleeping:
  // either this load sees the new head, or the producer sees that somebody is to be woken.
  at.board.writer.store_sleeping(true);
  const Word head = at.ring.ring.head(std::memory_order_seq_cst);
  const core::Time due = at.solver.due();
  const core::Time now = due < core::Time::max() ? MonotonicClock().now() : core::Time::zero();
  if (head == at.solver.seen() && due > now && !at.ring.ring.retired()) {
    wait_while_equal(at.ring.ring.head_word(), head, std::min({timeout, kSlice, due - now}));
  }
  at.board.writer.store_sleeping(false);
}

void Solver::prefetch(Stage stage) const noexcept {
  if (stage == Stage::self) return prefetch_lines(impl_.get(), sizeof(Impl));
  if (!attached()) return;
  const Attachment& at = *impl_->attachment;
  if (stage == Stage::parts) {
    prefetch_lines(&at.ring.ring, sizeof(at.ring.ring));
    prefetch_lines(&at.board.writer, sizeof(at.board.writer));
    prefetch_lines(&at.board.reader, sizeof(at.board.reader));
    prefetch_lines(&at.solver, sizeof(at.solver));
  } else {
    at.solver.prefetch();
  }
}

SolverWatch Solver::watch() const noexcept {
  const Attachment& at = *impl_->attachment;
  return {at.ring.ring.polled(), at.solver.seen(), at.solver.due(), at.solver.settled_raise()};
}

void Solver::first_refusals(std::vector<ItemRefusal>& out) {
  out.clear();
  if (!attached()) return;
  Attachment& at = *impl_->attachment;
  if (at.solver.head().refused == at.refusals_seen) return;
  at.refusals_seen = at.solver.head().refused;
  at.refusals.look(at.board.reader, at.ring.ring, at.refused);
  for (const ItemRefusal& refusal : at.refused.items) {
    bool& told = at.told[static_cast<std::size_t>(refusal.reason) % at.told.size()];
    if (!told) out.push_back(refusal);
    told = true;
  }
}

std::optional<LimitExcess> Solver::first_excess() noexcept {
  if (!attached() || impl_->attachment->is_excess_told) return std::nullopt;
  Attachment& at = *impl_->attachment;
  const Head& head = at.solver.head();
  while (at.excesses_seen < head.exceeding) {
    const auto excess = at.board.reader.excess(head, at.excesses_seen++);
    at.is_excess_told = excess && !excess->is_refused;
    if (at.is_excess_told) return excess;
  }
  return std::nullopt;
}

std::string Solver::in_words(const LimitExcess& excess) const {
  return "item " + std::to_string(excess.item) + ", " +
         ipc::in_words(excess, dimension_names(board()));
}

const Head& Solver::head() const noexcept { return impl_->attachment->solver.head(); }
const RegionHeader& Solver::board() const noexcept { return impl_->attachment->board.header; }

bool Solver::took_over() const noexcept {
  return attached() && impl_->attachment->board.taken_over;
}
bool Solver::is_memory_locked() const noexcept {
  return attached() && impl_->attachment->board.region.is_memory_locked();
}
const std::string& Solver::stream() const noexcept { return impl_->stream; }

}  // namespace splinecast::ipc
