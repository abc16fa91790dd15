#include "splinecast/reader.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "core/laws/motion.hpp"
#include "core/limits/check.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/old_motion.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"

namespace splinecast {
namespace {

constexpr Time kPoll = std::chrono::milliseconds(2);
/// Maximum length of one futex wait: a solver may die between its commit and its wake, or a woken
/// thread before it has woken the others.
constexpr Time kSlice = std::chrono::milliseconds(50);
constexpr int kSummaryTries = 16;

/// Whether the board belongs to the producer's current stream, if there is a producer: after a
/// stream was recreated, the old board remains until its motion ends and a solver attaches.
bool is_of_current_stream(const std::string& stream, const ipc::RegionHeader& header,
                          const Trust& trust) {
  try {
    const auto producers = ipc::peek_header(stream, ipc::RegionKind::waypoints, trust);
    return !producers || producers->stream_id == header.stream_id;
  } catch (const OutOfResources&) {
    throw;  // it cannot be checked now
  } catch (const StreamError&) {
    return true;  // a reader may lack the permission to read the producer's region
  }
}

}  // namespace

struct Reader::Impl {
  std::string stream;
  ipc::BoardView board;
  ipc::Sampler sampler;
  std::unique_ptr<ipc::LawFollower> law;
  MotionLimits limits;
  State state;  ///< scratch
  ipc::Word seen = 0;
  Time passed = Time::min();  ///< a host time that had passed before the law was read

  /// See ipc::LawFollower::final_until(); max() without a law.
  Time final_until() noexcept {
    return law ? law->final_until(MonotonicClock().now()) : Time::max();
  }

  /// Reads the clock if that may decide whether the law has settled at a host time. Call it before
  /// the law is read: by the deadline rule no revision of a law changes it before its commit, so a
  /// law that is read after a time has passed is final there, and needs no living solver. In the
  /// other order, this process may be delayed in between, and the law may have changed.
  void see_passed(Time host) noexcept {
    if (host > passed && host >= law->settled_until()) passed = MonotonicClock().now();
  }

  Impl(std::string name, ipc::BoardView mapped)
      : stream(std::move(name)),
        board(std::move(mapped)),
        sampler(board.reader, ipc::stream_clock(board.header), ipc::dimension_kinds(board.header)),
        limits(ipc::motion_limits(board.header)),
        state(board.reader.dimensions()) {}

  /// Maps the stream's board; returns null if there is none now.
  static std::unique_ptr<Impl> open(const std::string& stream, const Trust& trust) {
    if (!ipc::region_exists(stream, ipc::RegionKind::spline)) return nullptr;
    try {
      constexpr bool kKeepsDescriptor = true;  // alive() reads the lock of the region
      auto impl = std::make_unique<Impl>(
          stream, ipc::BoardView(ipc::open_board(stream, false, trust), kKeepsDescriptor));
      const ipc::RegionHeader& header = impl->board.header;
      const bool is_current = is_of_current_stream(stream, header, trust);
      if (is_current) ipc::require_same_clock(header, stream);
      // A motion that has not ended moves the machine, also if a newer stream waits for its end.
      const bool may_move = is_current || ipc::end_of_motion(header, impl->board.reader, trust) >
                                              MonotonicClock().now();
      if (!may_move) return nullptr;
      if (header.law_id != 0) impl->law = std::make_unique<ipc::LawFollower>(header, trust);
      return impl->board.reader.retired() ? nullptr : std::move(impl);
    } catch (const LawLost&) {
      throw;
    } catch (const NoSuchStream&) {
      return nullptr;  // removed between the check and the opening
    }
  }

  static std::unique_ptr<Impl> await(const std::string& stream, Time wait, const Trust& trust) {
    const MonotonicClock clock;
    const Time end = deadline(clock, wait);
    for (;;) {
      if (auto impl = open(stream, trust)) return impl;
      if (clock.now() >= end) {
        throw NoSuchStream("there is no stream '" + stream + "' with a solver");
      }
      std::this_thread::sleep_for(kPoll);
    }
  }
};

Reader::Reader(const std::string& stream, Time wait, const Trust& trust)
    : impl_((ipc::require_stream_name(stream), Impl::await(stream, wait, trust))),
      sampler_(&impl_->sampler),
      follows_law_(impl_->law != nullptr),
      dimensions_(impl_->board.reader.dimensions()) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

SampleStatus Reader::sample(Time t, const StateRef& out) noexcept {
  return follows_law_ ? follow(t, out, true) : sampler_->sample(t, out);
}

SampleStatus Reader::preview(Time t, const StateRef& out) noexcept {
  return follows_law_ ? follow(t, out, false) : sampler_->preview(t, out);
}

SampleStatus Reader::follow(Time host, const StateRef& out, bool is_executed) noexcept {
  impl_->see_passed(host);
  return follow_seen(host, out, is_executed);
}

/// Samples the curve at the stream time of a host time, with the derivatives by host time. The
/// sample has settled if both the law and the curve have. Requires see_passed() before.
SampleStatus Reader::follow_seen(Time host, const StateRef& out, bool is_executed) noexcept {
  ipc::LawFollower& law = *impl_->law;
  ipc::LawPoint point;
  const SampleStatus seen = law.look_up(host, is_executed, point);
  if (!has_values(seen)) return seen;
  const SampleStatus status = sample_point(point, out, is_executed);
  if (!has_values(status)) return status;
  rate_ = {.stream_time = point.stream, .rate = point.rates.rate, .slope = point.rates.slope};
  if (seen == SampleStatus::revised) return seen;
  if (seen == SampleStatus::settled || status != SampleStatus::settled) return status;
  return host <= impl_->passed ? status : SampleStatus::provisional;
}

SampleStatus Reader::sample_point(const ipc::LawPoint& point, const StateRef& out,
                                  bool is_executed) noexcept {
  ipc::Sampler::Place place;
  if (sampler_->all_linear() && sampler_->fits(out) &&
      sampler_->find_current(point.stream, is_executed, place)) {
    core::evaluate(place.order, place.coefficients, place.u + point.fraction, point.rates, out);
    return place.status;
  }
  const SampleStatus status = is_executed ? sampler_->sample(point.stream, point.fraction, out)
                                          : sampler_->preview(point.stream, point.fraction, out);
  if (has_values(status)) core::follow(point.rates, out);
  return status;
}

std::uint64_t Reader::sample_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  return follows_law_ ? follow_many(times, out) : sampler_->sample_many(times, out);
}

/// Samples the curve at many host times, all under one revision of the curve and of the law.
std::uint64_t Reader::follow_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  const std::size_t values = count(out.derivatives) * dimensions_;
  if (out.status.size() != times.size() || out.values.size() != times.size() * values) {
    std::ranges::fill(out.status, SampleStatus::wrong_dimension);
    return 0;
  }
  State& state = impl_->state;
  impl_->passed = MonotonicClock().now();  // as see_passed(), once for all times
  constexpr int kTries = 16;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    std::uint64_t revision = 0;
    std::uint64_t law_revision = 0;
    bool is_one = true;
    for (std::size_t i = 0; i < times.size() && is_one; ++i) {
      out.status[i] = follow_seen(times[i], state.ref(), false);
      if (i == 0) revision = sampler_->revision_seen();
      if (i == 0) law_revision = impl_->law->revision_seen();
      is_one = revision == sampler_->revision_seen() &&
               law_revision == impl_->law->revision_seen() && out.status[i] != SampleStatus::busy;
      if (is_one && has_values(out.status[i])) {
        ipc::copy_derivatives(state, out.derivatives, out.values.subspan(i * values, values));
      }
    }
    if (is_one) return revision;
  }
  std::ranges::fill(out.status, SampleStatus::busy);
  return 0;
}

Time Reader::settled_until() const noexcept {
  if (!follows_law_) return sampler_->settled_until();
  const Time final_until = impl_->final_until();
  return std::min(final_until, impl_->board.reader.look().settled_until);
}

SampleStatus Reader::snapshot(Time from, Time to, Snapshot& out) {
  const Time final_until = impl_->final_until();
  const SampleStatus status = sampler_->snapshot(from, to, *out.board_);
  out.board_->settle_at_most(final_until);
  const bool may_change = status == SampleStatus::settled && !out.board_->has_settled(to);
  return may_change ? SampleStatus::provisional : status;
}

std::optional<CurveProgress> Reader::progress() const noexcept {
  ipc::Summary summary;
  const Time final_until = impl_->final_until();
  if (!ipc::Internals::summary(*this, summary)) return std::nullopt;
  const Time settled =
      summary.finished ? summary.settled_until : std::min(summary.settled_until, final_until);
  return CurveProgress{.revision = summary.revision,
                       .newest = summary.newest_time,
                       .settled_until = settled,
                       .is_finished = summary.finished,
                       .waypoints = summary.knots,
                       .refused = summary.refused};
}

std::optional<Time> Reader::first_time() const noexcept {
  ipc::Summary bounds;
  for (int attempt = 0;
       attempt < kSummaryTries && ipc::Internals::summary(*this, bounds) && bounds.newest != 0;
       ++attempt) {
    core::SegmentForm form{};
    Time first{};
    if (impl_->board.reader.copy_time(bounds.first, bounds.revision, first, form)) return first;
  }
  return std::nullopt;
}

WaitStatus Reader::wait(Time timeout) noexcept {
  const MonotonicClock clock;
  const Time end = deadline(clock, timeout);
  impl_->seen = std::max(impl_->seen, impl_->sampler.revision_seen());
  for (;;) {
    if (impl_->board.reader.retired()) return WaitStatus::retired;
    const ipc::Word revision = impl_->board.reader.revision();
    if (revision != impl_->seen) {
      impl_->seen = revision;
      return WaitStatus::advanced;
    }
    const Time left = end - clock.now();
    if (left <= Time::zero()) return WaitStatus::timed_out;
    (void)ipc::wait_for_change(impl_->board.reader.revision_word(), revision,
                               std::min(left, kSlice));
  }
}

Alive Reader::alive() const noexcept {
  const auto may_live = [this](ipc::RegionKind kind) {
    try {
      return ipc::owner_lives(impl_->stream, kind);
    } catch (const std::exception&) {
      return true;
    }
  };
  return {.producer = may_live(ipc::RegionKind::waypoints),
          .solver = ipc::region_owner_lives(impl_->board.region.descriptor()) ||
                    (impl_->board.region.is_linked(impl_->stream, ipc::RegionKind::spline) &&
                     may_live(ipc::RegionKind::spline))};
}

const MotionLimits& Reader::limits() const noexcept { return impl_->limits; }

Excess Reader::excess(const State& sampled) const noexcept {
  if (sampled.dimensions() != dimensions_) return {};
  return core::worst_excess(impl_->limits, &sampler_->kinds(), sampled);
}

StreamClock Reader::clock() const noexcept { return ipc::stream_clock(impl_->board.header); }
std::vector<std::string> Reader::names() const { return ipc::dimension_names(impl_->board.header); }
DimensionKinds Reader::kinds() const { return ipc::dimension_kinds(impl_->board.header); }
std::vector<std::string> Reader::units() const { return ipc::dimension_units(impl_->board.header); }
bool Reader::is_memory_locked() const noexcept { return impl_->board.region.is_memory_locked(); }

namespace ipc {

ipc::Sampler& ipc::Internals::sampler(Reader& reader) noexcept { return *reader.sampler_; }

const ipc::RegionHeader& ipc::Internals::header(const Reader& reader) noexcept {
  return reader.impl_->board.header;
}

bool ipc::Internals::summary(const Reader& reader, ipc::Summary& out) noexcept {
  return reader.impl_->board.reader.copy_newest_summary(out);
}

}  // namespace ipc
}  // namespace splinecast
