#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/memory/folder_watch.hpp"
#include "ipc/roles/solver_watch.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::ipc {

/// What a sweep reports of a stream.
enum class SweepNews : std::uint8_t {
  waiting,         ///< there is no producer yet, or the stream has been removed
  solving,         ///< it is solved here now
  finished,        ///< its end has been solved
  elsewhere,       ///< another process solves it; taken over when that dies
  no_descriptors,  ///< RLIMIT_NOFILE leaves none for it; tried again when streams have come or gone
  refused,         ///< an item was refused, the first one for its reason
  beyond_limits,   ///< the curve exceeds a limit with a waypoint that was taken, the first one
  postponed,       ///< memory or descriptors are lacking; retried periodically
  given_up,        ///< it cannot be solved; tried again when other files exist under its name
  gone,            ///< a stream that was found by a pattern no longer exists
};

/// The solvers of many streams in one thread. The streams are named, or found by patterns as they
/// come and go.
///
/// A sweep polls one cache line of each stream and steps those that have work to do. It polls a
/// stream that has been idle for a second only every 20 ms, the idle streams in turn, because such
/// a poll misses the caches for that line and its page. The rest of its work, which takes system
/// calls, is done every 50 ms, and only if files have come or gone in the folder of shared memory
/// or another process solves a wanted stream. A sweep attaches to at most one stream, because that
/// maps memory, and the others must not wait long. Allocates only when streams come and go.
class StreamSweep {
 public:
  /// Called when the state of a stream has changed, and for its first refusals, excess and finish.
  /// `solver` is not null if the stream is solved here; `why` is set for `postponed`, `given_up`,
  /// `refused` and `beyond_limits`. Exceptions that it throws are ignored.
  using Tell = std::function<void(SweepNews news, const std::string& stream, const Solver* solver,
                                  std::string_view why)>;

  /// Each of `wanted` is a stream's name or a pattern, see is_pattern(). From now on no other
  /// process can solve a named stream, even while it has no producer. All are solved with these
  /// options. Throws BadRequest for invalid options or names; calls `tell` already here. `pause` is
  /// the time between two sweeps.
  StreamSweep(const std::vector<std::string>& wanted, SolverOptions options, Tell tell,
              Time pause = std::chrono::milliseconds(1));

  /// Polls every stream once. Returns whether one of them still has work to do: sweep again at
  /// once. A stream that fails is given up or postponed; the others continue.
  bool sweep(const Clock& clock);

  /// The time to wait before the next sweep: `pause`, or kQuietPause if that is longer and all
  /// streams are idle. The next sweep then polls all of them.
  [[nodiscard]] Time next_pause() const noexcept;

  /// A stream without work for kQuietAfter is idle: it is polled once per kQuietPause.
  static constexpr Time kQuietAfter = std::chrono::seconds(1);
  static constexpr Time kQuietPause = std::chrono::milliseconds(20);

  /// Number of streams that are solved here.
  [[nodiscard]] std::size_t solved() const noexcept { return served_.size(); }

  /// File descriptors that a stream takes while it is solved: the lock and the board.
  static constexpr std::size_t kDescriptorsPerStream = 2;

 private:
  /// Maximum number of streams tried in one sweep, and of streams of other processes checked in one
  /// call. When one of these has lost its solver, the count restarts: usually it solved the
  /// others too.
  static constexpr std::size_t kTries = 16;

  /// Interval between retries of the streams that lack memory or descriptors, one per retry; once
  /// one has succeeded, the next look retries another.
  static constexpr Time kRetry = std::chrono::milliseconds(100);

  enum class State : std::uint8_t {
    unowned,
    waiting,
    solved,
    elsewhere,
    no_descriptors,
    postponed,
    given_up
  };

  /// Inodes of the ring, of the board, and of a lock file that is another user's; 0 for none.
  using Files = std::array<std::uint64_t, 3>;

  struct Member {
    bool is_named = false;
    State state = State::unowned;
    std::unique_ptr<Solver> waiting{};  ///< while there is no producer
    Files files{};                      ///< given_up: those that existed then
  };

  struct Served {
    std::unique_ptr<Solver> solver;
    bool was_finished = false;
    std::exception_ptr failure{};  ///< of a step
  };

  /// What a sweep reads of a stream without work.
  struct Watch {
    SolverWatch solver;
    Time active;  ///< when it was last stepped
  };

  // Which streams are wanted and ready: discovery.cpp.
  void look_around();
  void look_for_names();
  [[nodiscard]] bool is_wanted(const std::string& stream) const;
  [[nodiscard]] static bool is_to_be_tried(const Member& member) noexcept;
  [[nodiscard]] static Files files_of(const std::string& stream);
  void note_ends_of_motion();
  void look_elsewhere();
  void look_at_postponed();

  // Attaching to streams, and giving them up: taking_up.cpp.
  void take_next(const Clock& clock);
  [[nodiscard]] bool own(const std::string& stream, Member& member);
  [[nodiscard]] bool attach(const std::string& stream, Member& member, const Clock& clock);
  void make_room();
  void hold_regions() noexcept;
  void release(Served& served);
  void drop(const std::string& stream, Member& member, const std::exception& error);

  // Stepping those that have work to do: stepping.cpp.
  void take_up(const Clock& clock);
  void collect_calling();
  void prefetch_behind(std::size_t i) const noexcept;
  [[nodiscard]] bool serve(std::size_t index, const Clock& clock);
  void tell_first_refusals(Solver& solver) noexcept;
  void release_detached();

  // States and reports.
  void become(const std::string& stream, Member& member, State state, SweepNews news,
              const Solver* solver = nullptr, std::string_view why = {}) noexcept;
  void tell(SweepNews news, const std::string& stream, const Solver* solver,
            std::string_view why) noexcept;
  [[nodiscard]] std::size_t owned() const noexcept;

  SolverOptions options_;
  Tell tell_;
  std::vector<std::string> patterns_;
  std::map<std::string, Member> members_;
  FolderWatch folder_;
  Time next_look_ = Time::min();
  bool looks_again_ = false;  ///< the last look for names was not finished
  Time next_retry_ = Time::min();
  std::string last_retried_;            ///< the postponed stream that was retried last
  bool is_any_unheld_ = false;          ///< whether a board may lack its region lock
  std::vector<std::string> to_take_;    ///< streams to try next, in reverse order
  std::vector<std::string> elsewhere_;  ///< streams that others solve, to check in reverse order
  std::vector<std::string> moving_;     ///< streams that wait for the end of an earlier motion
  std::size_t most_owned_;              ///< the maximum that RLIMIT_NOFILE allows
  std::vector<Watch> watches_;          ///< all that a sweep reads of an idle stream
  std::vector<Served> served_;          ///< the same streams, index by index
  std::vector<std::size_t> calling_;    ///< indices of the streams that this sweep steps
  std::vector<ItemRefusal> refused_;    ///< scratch
  Time now_{};                          ///< time of this sweep
  Time pause_;
  std::size_t quiet_sweeps_;  ///< one sweep out of this many polls an idle stream
  std::size_t sweeps_ = 0;
  bool all_quiet_ = false;
  bool has_detached_ = false;
};

}  // namespace splinecast::ipc
