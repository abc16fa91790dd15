#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/limits/check.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// Why `Reader::wait` returned.
enum class WaitStatus : std::uint8_t {
  advanced,  ///< there is a revision that this reader had not seen
  timed_out,
  retired,  ///< attach again
};

/// Which of a stream's writers live.
struct Alive {
  bool producer = false;
  bool solver = false;
};

/// The role that reads the curve: what a controller links. Any number of processes read one stream;
/// in each, one thread uses a reader, and every thread may have its own.
class Reader {
 public:
  /// Maps the stream's segment board, waiting for it up to `wait`. Throws NoSuchStream if none has
  /// come by then, BadRegion if it cannot be used.
  explicit Reader(const std::string& stream, core::Time wait = core::Time::zero(),
                  const Trust& trust = {});
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }

  /// Evaluates position, velocity, acceleration and jerk at time `t` of the stream's clock into
  /// `out`, one value per dimension in each span; a wrapping position within half a period of 0, a
  /// quaternion at unit length (core::angular_motion gives its ω and α). Wait-free: no system call,
  /// no allocation, no store to shared memory, whatever the writers do. O(D) where time advances,
  /// O(log n + D) at a jump. Where the status has no values, `out` is left as it was; where a span
  /// has another size, as after attaching to a stream of other dimensions, it is `wrong_dimension`.
  [[nodiscard]] SampleStatus sample(core::Time t, const core::StateRef& out) noexcept {
    return sampler_->sample(t, out);
  }
  [[nodiscard]] SampleStatus sample(core::Time t, core::State& out) noexcept {
    return sampler_->sample(t, out);
  }

  /// The same for a look ahead of what is settled, which does not count as executed: see
  /// Sampler::preview.
  [[nodiscard]] SampleStatus preview(core::Time t, const core::StateRef& out) noexcept {
    return sampler_->preview(t, out);
  }
  [[nodiscard]] SampleStatus preview(core::Time t, core::State& out) noexcept {
    return preview(t, out.ref());
  }

  /// Evaluates the curve at many times, all of one revision, which it returns: for controllers that
  /// look ahead. See Sampler::sample_many.
  Word sample_many(std::span<const core::Time> times, const SampleBlock& out) noexcept {
    return sampler_->sample_many(times, out);
  }

  /// What `sample` asks: for code that works on streams in plain memory as well.
  [[nodiscard]] Sampler& sampler() noexcept { return *sampler_; }

  /// The time before which what the last sample saw never changes.
  [[nodiscard]] core::Time settled_until() const noexcept { return sampler_->settled_until(); }

  /// Copies the segments between two times, all of one revision: see Sampler::snapshot.
  [[nodiscard]] SampleStatus snapshot(core::Time from, core::Time to, Snapshot& out) {
    return sampler_->snapshot(from, to, out);
  }

  /// The stream's limits; empty if it has none. They never change.
  [[nodiscard]] const core::MotionLimits& limits() const noexcept;

  /// Marks a sample: where it is nearest to a limit of the stream, or farthest beyond it; a ratio
  /// above 1 is beyond. O(D), allocates nothing.
  [[nodiscard]] core::Excess excess(const core::State& sampled) const noexcept;

  /// Copies the head of the newest revision. Returns false if there is none, or if the writer
  /// overtook every try.
  [[nodiscard]] bool head(Head& out) const noexcept;

  /// Time of the oldest knot that the board keeps. Returns false if there is none yet, or if the
  /// writer overtook every try.
  [[nodiscard]] bool first_time(core::Time& out) const noexcept;

  /// Sleeps until a revision that this reader has not seen, for programs that need not spin.
  [[nodiscard]] WaitStatus wait(core::Time timeout) noexcept;

  /// Which writers live: system calls, so not inside a control loop. A writer of whom this cannot
  /// be known, because no descriptor is left to look with, counts as alive.
  [[nodiscard]] Alive alive() const noexcept;

  /// What the stream's header says.
  [[nodiscard]] const RegionHeader& header() const noexcept;
  [[nodiscard]] StreamClock clock() const noexcept;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] core::DimensionKinds kinds() const;
  [[nodiscard]] bool is_memory_locked() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Sampler* sampler_;  ///< inside impl_
  std::size_t dimensions_;
};

}  // namespace splinecast::ipc
