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
/// Runs in a process of its own or inside the producer's: the same code and the same regions. One
/// thread uses it; it has none of its own. While it lives, no other process can become the solver
/// of the same stream.
///
/// Once attach() has returned true, the program that has the Solver must call `step` after each
/// item that the producer appends, and, for a live stream, no later than `due()`, also while
/// nothing is appended: `step` publishes how far the curve has settled, and readers whose time
/// passes `settled_until` get provisional samples. A thread that does something else meanwhile,
/// such as waiting for the next waypoint, waits like this:
///
///     while (!solver.attach(clock)) solver.wait(50ms);  // until the stream is there
///     while (clock.now() < next) {
///       while (solver.step(clock).consumed > 0) {}
///       solver.wait(next - clock.now());  // returns when the solver is due
///     }
class Solver {
 public:
  /// Becomes the stream's solver, whether or not the stream stands already. Throws StreamBusy if it
  /// has a living one, BadRequest for a name or options that can be no stream's, BadRegion if the
  /// lock or a board of that name cannot be used.
  Solver(std::string stream, const SolverOptions& options);
  /// Throws BadRequest for options that can be no stream's; the constructor does so too.
  static void require(const SolverOptions& options);

  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;
  ~Solver();

  /// Takes the stream up once its producer has made it: goes on with the board of a solver that
  /// died, retires the board of an earlier stream, or makes a new one. Returns false while there is
  /// no stream, and while the curve of an earlier live stream has not come to rest, which readers
  /// still follow: due() is when it will have. Throws BadRequest if the options contradict a board
  /// that is taken over or the limits do not fit the dimensions, BadRegion if a region cannot be
  /// used, continued or made, or if that curve moves for more than an hour. System calls; does
  /// nothing if attached. `clock`, by default CLOCK_MONOTONIC, is the one that steps are given.
  bool attach();
  bool attach(const Clock& clock);
  [[nodiscard]] bool attached() const noexcept;

  /// Takes what waypoints there are and publishes. Does nothing unless attached(). It detaches when
  /// the stream has been removed, withdrawn or made again, in the first step that takes no item;
  /// then call attach() again. No system call but the clock's and, with SolverOptions::wake, one
  /// wake a revision, of bounded cost however many readers wait. Throws BadRegion if another
  /// process has written to the board.
  StepResult step(const Clock& clock);

  /// Sleeps until there may be something to do, at the latest until `due()`, or for the timeout, or
  /// for 50 ms; for 5 ms at most while not attached. Returns at once for a timeout that is not
  /// positive. Goes by CLOCK_MONOTONIC, whatever clock steps are given. System calls.
  void wait(Time timeout) noexcept;

  /// When `step` must be called next even if no item comes, on the clock that steps are given: at
  /// most half of freeze-ahead after the last step of a live stream that moves. max() for never: a
  /// recorded stream, or one at rest. Not attached: when `attach` is to be tried again if that is
  /// known, else max(): then try every few milliseconds.
  [[nodiscard]] Time due() const noexcept;

  /// Replaces the contents of `out` by the first refusal for each reason since this solver
  /// attached, except those that an earlier call has given. O(1) unless an item was refused since
  /// the last call.
  void take_first_refusals(std::vector<ItemRefusal>& out);

  /// The first waypoint since this solver attached that was taken although the curve passes a limit
  /// with it, once. O(1) unless another one has been taken since the last call.
  [[nodiscard]] std::optional<LimitExcess> take_first_excess() noexcept;

  /// `item 17, acceleration of dimension 2 (wrist) is …`; attached() only.
  [[nodiscard]] std::string in_words(const LimitExcess& excess) const;

  /// Whether this solver went on with a board that a dead one left.
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
