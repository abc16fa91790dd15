#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ipc/roles/refusals.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// Where to look whether a step of a solver would be of use; for whoever looks after many. Made
/// anew after each step, and of no use once its solver has detached.
class SolverWatch {
 public:
  SolverWatch(std::span<const Word, 2> polled, Word seen, core::Time due,
              const SettledRaise& raise) noexcept
      : polled_(polled), seen_(seen), due_(due), raise_(raise) {}

  /// Whether the ring holds what the last step has not seen. One load of a word that only the
  /// producer writes.
  [[nodiscard]] bool has_items() const noexcept {
    return load(polled_[kHead], std::memory_order_acquire) != seen_;
  }

  /// Whether a step is of use at `now` whatever the ring holds: a revision is due.
  [[nodiscard]] bool is_due(core::Time now) const noexcept { return due_ <= now; }

  /// Raises the stream's settled time if nothing else is due at `now`. Returns whether that was so;
  /// else the stream needs a step. Stores at most one word.
  bool settle(core::Time now) noexcept {
    if (!raise_.raise(now)) return false;
    due_ = now + raise_.interval();
    return true;
  }

  /// Whether a step is of use for what the producer has done: there are items, or the stream has
  /// been retired. Loads from one cache line.
  [[nodiscard]] bool calls() const noexcept {
    return has_items() || load(polled_[kRetired], std::memory_order_acquire) != 0;
  }

  /// When the next revision is due without items; max() for never.
  [[nodiscard]] core::Time due() const noexcept { return due_; }

 private:
  std::span<const Word, 2> polled_;
  Word seen_;
  core::Time due_;
  SettledRaise raise_;
};

/// The role that turns waypoints into segments: the one writer of a stream's segment board.
///
/// Runs in a process of its own or inside the producer's: the same code and the same regions. One
/// thread uses it; it has none of its own. While it lives, no other process can become the solver
/// of the same stream.
///
/// The program that has the Solver must call `step` after each item that the producer appends, and,
/// for a live stream, no later than `due()`, also while nothing is appended: `step` publishes how
/// far the curve has settled, and readers whose time passes `settled_until` get provisional
/// samples. A thread that does something else meanwhile, such as waiting for the next waypoint,
/// waits like this:
///
///     while (clock.now() < next) {
///       while (solver.step(clock).consumed > 0) {}
///       solver.wait(next - clock.now());  // returns when the solver is due
///     }
class Solver {
 public:
  /// Becomes the stream's solver, whether or not the stream stands already. Throws StreamBusy if it
  /// has a living one.
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
  /// that is taken over, BadRegion if a region cannot be used, continued or made, or if that curve
  /// moves for more than kLongestOldMotion. System calls; does nothing if attached. `clock`, by
  /// default CLOCK_MONOTONIC, is the one that steps are given.
  bool attach();
  bool attach(const Clock& clock);
  [[nodiscard]] bool attached() const noexcept;

  /// Takes the lock on the board by which other users see that its solver lives, if a lock of
  /// theirs kept this solver from it before. wait(), and step() where it wakes readers, do so too.
  /// Returns whether it is held. A system call if it was not.
  bool hold_region() noexcept;

  /// Takes what waypoints there are and publishes; detaches when the stream has been retired or
  /// made again. No system call but the clock's and, with SolverOptions::wake, one wake a revision,
  /// of bounded cost however many readers wait (wake_some). Throws BadRegion if another process has
  /// written to the board.
  StepResult step(const Clock& clock);

  /// Sleeps until there may be something to do, at the latest until `due()`, or for the timeout, or
  /// for 50 ms. Returns at once for a timeout that is not positive.
  void wait(core::Time timeout) noexcept;

  /// When `step` must be called next even if no item comes, on CLOCK_MONOTONIC: at most half of
  /// freeze-ahead after the last step of a live stream that moves. max() for never: a recorded
  /// stream, or one at rest. Not attached: when `attach` is to be tried again, if that is known.
  [[nodiscard]] core::Time due() const noexcept;

  /// What `prefetch` asks for: this object, the parts that it points to, or the stream's memory.
  /// Each stage loads what the one before has asked for.
  enum class Stage { self, parts, stream };

  /// Asks for memory that the next step uses, for a program that steps many solvers in turn.
  void prefetch(Stage stage) const noexcept;

  /// What to look at before the next step; attached() only.
  [[nodiscard]] SolverWatch watch() const noexcept;

  /// Replaces the contents of `out` by the first refusal for each reason since this solver
  /// attached, except those that an earlier call has given. O(1) unless an item was refused since
  /// the last call.
  void first_refusals(std::vector<ItemRefusal>& out);

  /// The first waypoint since this solver attached that was taken although the curve passes a limit
  /// with it, once. O(1) unless another one has been taken since the last call.
  [[nodiscard]] std::optional<LimitExcess> first_excess() noexcept;

  /// `item 17, acceleration of dimension 2 (wrist) is …`; attached() only.
  [[nodiscard]] std::string in_words(const LimitExcess& excess) const;

  /// The head last committed; attached() only.
  [[nodiscard]] const Head& head() const noexcept;

  /// The header of the board, which says how the stream is solved; attached() only.
  [[nodiscard]] const RegionHeader& board() const noexcept;

  /// Whether this solver went on with a board that a dead one left.
  [[nodiscard]] bool took_over() const noexcept;
  [[nodiscard]] bool is_memory_locked() const noexcept;
  [[nodiscard]] const std::string& stream() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast::ipc
