#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {
struct Internals;
}  // namespace splinecast::ipc

namespace [[gnu::visibility("default")]] splinecast {

/// The role that turns waypoints into segments: the one writer of a stream's knot board.
///
/// Runs in its own process or in the producer's, with the same code and the same regions. One
/// thread uses it; it starts none. While it lives, no other process can become the solver of the
/// same stream.
///
/// Once attach() has returned true, the program must call `step` after each item that the producer
/// appends and, for a live stream, no later than `due()`, even if nothing is appended: `step`
/// publishes how far the curve has settled, and readers whose time passes `settled_until` get
/// provisional samples. A thread that also waits for something else, such as the next waypoint,
/// waits like this:
///
///     while (!solver.attach(clock)) solver.wait(50ms);  // until the stream is there
///     while (clock.now() < next) {
///       while (solver.step(clock).consumed > 0) {}
///       solver.wait(next - clock.now());  // returns when the solver is due
///     }
class Solver {
 public:
  /// Becomes the stream's solver; the stream need not exist yet. Throws StreamBusy if it has a
  /// living solver, BadRequest for an invalid name or invalid options, BadRegion if the lock or a
  /// board of that name cannot be used.
  Solver(std::string stream, const SolverOptions& options);
  /// Throws BadRequest for invalid options, as the constructor does.
  static void require(const SolverOptions& options);

  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;
  ~Solver();

  /// Attaches to the stream once its producer has created it: continues the board of a dead solver,
  /// retires the board of an earlier stream, or creates a new one. Returns false if there is no
  /// stream, or while the curve of an earlier live stream, which readers still follow, is not at
  /// rest: due() is the time when it will be. Throws BadRequest if the options contradict a board
  /// that is taken over or the limits do not fit the dimensions; BadRegion if a region cannot be
  /// used, continued or created, or if that curve moves for more than an hour. System calls; does
  /// nothing if attached. `clock` is the clock passed to `step`; default CLOCK_MONOTONIC.
  bool attach();
  bool attach(const Clock& clock);
  [[nodiscard]] bool attached() const noexcept;

  /// Consumes waypoints from the ring and publishes. Does nothing unless attached(). If the stream
  /// has been removed, withdrawn or created again, the first step that has nothing to do detaches;
  /// then call attach() again. No system calls except the clock's and, with SolverOptions::wake,
  /// one wake per revision, of bounded cost for any number of waiting readers, and one in 4 ms to
  /// learn of new stoppers. With `wake` false, wait() does that, also with the timeout 0. Throws
  /// BadRegion if another process has written to the board.
  StepResult step(const Clock& clock);

  /// Sleeps until there may be work to do, but not beyond `due()`, the timeout or 50 ms (not
  /// attached: 5 ms). Returns at once if the timeout is 0 or less. Uses CLOCK_MONOTONIC, regardless
  /// of the clock passed to `step`. System calls.
  void wait(Time timeout) noexcept;

  /// When `step` must be called next even if no item arrives, on the clock passed to `step`. Live
  /// stream in motion: at most half of freeze-ahead after the last step. Recorded stream, or stream
  /// at rest: max(), for never. Not attached: when to retry `attach`, if that is known, else max():
  /// then retry every few milliseconds.
  [[nodiscard]] Time due() const noexcept;

  /// Replaces the contents of `out` by the first refusal for each reason since this solver
  /// attached, except those that an earlier call returned. O(1) unless an item was refused since
  /// the last call.
  void take_first_refusals(std::vector<ItemRefusal>& out);

  /// The first waypoint since this solver attached that was accepted although the curve exceeds a
  /// limit with it. Returned once. O(1) unless another such waypoint was accepted since the last
  /// call.
  [[nodiscard]] std::optional<LimitExcess> take_first_excess() noexcept;

  /// Of a time law: adds what a person must know of its commanders to `out`, one sentence each:
  /// those that are not heard, and those that hold the law because their dead man has fired or
  /// their request is damaged. Of another live stream: its stoppers that hold it, and those that
  /// are not heard. Each once, as long as it lasts. Looks every 20 ms. Allocates.
  void take_commander_faults(std::vector<std::string>& out);

  /// `item 17, acceleration of dimension 2 (wrist) is …`; attached() only.
  [[nodiscard]] std::string in_words(const LimitExcess& excess) const;

  /// Whether this solver continued the board of a dead one.
  [[nodiscard]] bool took_over() const noexcept;

  /// Whether the region's pages are locked into memory: best effort, see RLIMIT_MEMLOCK. False
  /// unless attached().
  [[nodiscard]] bool is_memory_locked() const noexcept;

  [[nodiscard]] const std::string& stream() const noexcept;

 private:
  friend struct ipc::Internals;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast
