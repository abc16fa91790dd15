#include "splinecast/reader.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "ipc/layout/limits.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/roles/stream_files.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr core::Time kPoll = std::chrono::milliseconds(2);
/// A wait is cut into slices, in case a solver dies between its commit and its wake, or a woken
/// thread before it has woken the others.
constexpr core::Time kSlice = std::chrono::milliseconds(50);
constexpr int kHeadTries = 16;

/// Whether the board belongs to the stream that its producer has made, if there is one: after a
/// stream was made anew, the old board stands until a solver comes.
bool is_of_current_stream(const std::string& stream, const RegionHeader& header,
                          const Trust& trust) {
  try {
    const auto producers = peek_header(stream, RegionKind::waypoints, trust);
    return !producers || producers->stream_id == header.stream_id;
  } catch (const OutOfResources&) {
    throw;  // nothing is known
  } catch (const StreamError&) {
    return true;  // a reader need not be allowed to read what the producer writes
  }
}

}  // namespace

struct Reader::Impl {
  std::string stream;
  Region region;
  RegionHeader header;
  KnotBoardReader board;
  Sampler sampler;
  core::MotionLimits limits;
  Word seen = 0;

  Impl(std::string name, Region mapped, const RegionHeader& described, const BoardLayout& layout)
      : stream(std::move(name)),
        region(std::move(mapped)),
        header(described),
        board(region.bytes(), layout),
        sampler(board, stream_clock(described), dimension_kinds(described)),
        limits(motion_limits(described)) {}

  /// Maps the stream's board, or returns nothing if there is none now.
  static std::unique_ptr<Impl> open(const std::string& stream, const Trust& trust) {
    if (!region_exists(stream, RegionKind::spline)) return nullptr;
    try {
      auto [region, header, layout] = open_board(stream, false, trust);
      if (!is_of_current_stream(stream, header, trust)) return nullptr;
      require_same_clock(header, stream);
      auto impl = std::make_unique<Impl>(stream, std::move(region), header, layout);
      return impl->board.retired() ? nullptr : std::move(impl);
    } catch (const NoSuchStream&) {
      return nullptr;  // it went between the look and the opening
    }
  }

  static std::unique_ptr<Impl> await(const std::string& stream, core::Time wait,
                                     const Trust& trust) {
    const MonotonicClock clock;
    const core::Time end = deadline(clock, wait);
    for (;;) {
      if (auto impl = open(stream, trust)) return impl;
      if (clock.now() >= end) {
        throw NoSuchStream("there is no stream '" + stream + "' with a solver");
      }
      std::this_thread::sleep_for(kPoll);
    }
  }
};

Reader::Reader(const std::string& stream, core::Time wait, const Trust& trust)
    : impl_((require_stream_name(stream), Impl::await(stream, wait, trust))),
      sampler_(&impl_->sampler),
      dimensions_(impl_->board.dimensions()) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

bool Reader::head(Head& out) const noexcept {
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const Look look = impl_->board.look();
    if (look.revision == 0) return false;
    if (impl_->board.copy_head(look, out)) return true;
  }
  return false;
}

bool Reader::first_time(core::Time& out) const noexcept {
  Head bounds;
  for (int attempt = 0; attempt < kHeadTries && head(bounds) && bounds.newest != 0; ++attempt) {
    core::SegmentForm form{};
    if (impl_->board.copy_time(bounds.first, bounds.revision, out, form)) return true;
  }
  return false;
}

WaitStatus Reader::wait(core::Time timeout) noexcept {
  const MonotonicClock clock;
  const core::Time end = deadline(clock, timeout);
  impl_->seen = std::max(impl_->seen, impl_->sampler.revision_seen());
  for (;;) {
    if (impl_->board.retired()) return WaitStatus::retired;
    const Word revision = impl_->board.revision();
    if (revision != impl_->seen) {
      impl_->seen = revision;
      return WaitStatus::advanced;
    }
    const core::Time left = end - clock.now();
    if (left <= core::Time::zero()) return WaitStatus::timed_out;
    (void)wait_for_change(impl_->board.revision_word(), revision, std::min(left, kSlice));
  }
}

Alive Reader::alive() const noexcept {
  const auto may_live = [this](RegionKind kind) {
    try {
      return owner_lives(impl_->stream, kind);
    } catch (const std::exception&) {
      return true;
    }
  };
  return {.producer = may_live(RegionKind::waypoints),
          .solver = region_owner_lives(impl_->region.descriptor()) ||
                    (impl_->region.is_linked(impl_->stream, RegionKind::spline) &&
                     may_live(RegionKind::spline))};
}

const core::MotionLimits& Reader::limits() const noexcept { return impl_->limits; }

core::Excess Reader::excess(const core::State& sampled) const noexcept {
  if (sampled.dimensions() != dimensions_) return {};
  return core::worst_excess(impl_->limits, &sampler_->kinds(), sampled);
}

const RegionHeader& Reader::header() const noexcept { return impl_->header; }
StreamClock Reader::clock() const noexcept { return stream_clock(impl_->header); }
std::vector<std::string> Reader::names() const { return dimension_names(impl_->header); }
core::DimensionKinds Reader::kinds() const { return dimension_kinds(impl_->header); }
bool Reader::is_memory_locked() const noexcept { return impl_->region.is_memory_locked(); }

}  // namespace splinecast::ipc
