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

/// What becomes of a stream that a sweep looks after.
enum class SweepNews : std::uint8_t {
  waiting,         ///< there is no producer yet, or the stream has been removed
  solving,         ///< it is solved here now
  finished,        ///< its end has been solved
  elsewhere,       ///< another process solves it; taken over when that dies
  no_descriptors,  ///< RLIMIT_NOFILE leaves none for it; tried again when streams have come or gone
  refused,         ///< an item was refused, the first one for its reason
  beyond_limits,   ///< the curve passes a limit with a waypoint that was taken, the first one
  postponed,       ///< memory or descriptors are lacking; tried again from time to time
  given_up,        ///< it cannot be solved; tried again when other files exist under its name
  gone,            ///< a stream that was found by a pattern stands no more
};

/// One thread's solvers of many streams, named, or found by patterns as they come and go.
///
/// A sweep looks at one cache line of each stream and steps those that have something to do. Of the
/// streams on which nothing has happened for a second it looks at some, each in its turn every 20
/// ms, because what such a look costs is fetching that line and its page into caches that have long
/// forgotten them. The rest of its work, which takes system calls, is done every 50 ms, and then
/// only if files have come or gone in the folder of shared memory or another process solves a
/// wanted stream. At most one stream is taken up in a sweep, because that maps memory, and the
/// others must not wait long. Allocates when streams come and go only.
class StreamSweep {
 public:
  /// Told at most once until something else becomes of the stream. `solver` is not null where the
  /// stream is solved here; `why` is for `postponed`, `given_up` and `refused`. What it throws is
  /// dropped.
  using Tell = std::function<void(SweepNews news, const std::string& stream, const Solver* solver,
                                  std::string_view why)>;

  /// Each of `wanted` is a stream's name or a pattern, see is_pattern(). A named stream is solved
  /// by nobody else from now on, also while it has no producer. All are solved with these options.
  /// Throws BadRequest for options or names that cannot be; `tell` is called here already.
  /// `pause` is what lies between two sweeps.
  StreamSweep(const std::vector<std::string>& wanted, SolverOptions options, Tell tell,
              Time pause = std::chrono::milliseconds(1));

  /// Looks after every stream once. Returns whether one of them has more to do than was done:
  /// sweep again at once. A stream that fails is given up or postponed; the others continue.
  bool sweep(const Clock& clock);

  /// How long to wait for the next sweep: `pause`, or kQuietPause if that is longer, while nothing
  /// happens on any stream. The next sweep then looks at all of them.
  [[nodiscard]] Time next_pause() const noexcept;

  /// A stream on which nothing has happened for so long is looked at once in so long.
  static constexpr Time kQuietAfter = std::chrono::seconds(1);
  static constexpr Time kQuietPause = std::chrono::milliseconds(20);

  /// Streams that are solved here.
  [[nodiscard]] std::size_t solved() const noexcept { return served_.size(); }

  /// File descriptors that a stream takes while it is solved: the lock and the board.
  static constexpr std::size_t kDescriptorsPerStream = 2;

 private:
  /// Streams that are tried at once, and streams of other processes that are looked at each time.
  /// When one of these has died, the rest follow at once: they were mostly the same process's.
  static constexpr std::size_t kTries = 16;

  /// How often one of the streams that lack memory or descriptors is tried again; once one has
  /// succeeded, the next look tries another.
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

  /// What a sweep reads of a stream that has nothing to do.
  struct Watch {
    SolverWatch solver;
    Time active;  ///< when it was last stepped
  };

  // Which streams are wanted and could be taken up: discovery.cpp.
  void look_around();
  void look_for_names();
  [[nodiscard]] bool is_wanted(const std::string& stream) const;
  [[nodiscard]] static bool is_to_be_tried(const Member& member) noexcept;
  [[nodiscard]] static Files files_of(const std::string& stream);
  void note_ends_of_motion();
  void look_elsewhere();
  void look_at_postponed();

  // Taking streams up, and giving them up: taking_up.cpp.
  void take_next(const Clock& clock);
  [[nodiscard]] bool own(const std::string& stream, Member& member);
  [[nodiscard]] bool attach(const std::string& stream, Member& member, const Clock& clock);
  void make_room();
  void hold_regions() noexcept;
  void release(Served& served);
  void drop(const std::string& stream, Member& member, const std::exception& error);

  // Stepping those that have something to do: stepping.cpp.
  void take_up(const Clock& clock);
  void collect_calling();
  void prefetch_behind(std::size_t i) const noexcept;
  [[nodiscard]] bool serve(std::size_t index, const Clock& clock);
  void tell_first_refusals(Solver& solver) noexcept;
  void release_detached();

  // What becomes of them.
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
  std::string last_retried_;            ///< of the postponed streams
  bool is_any_unheld_ = false;          ///< whether a board may lack its region lock
  std::vector<std::string> to_take_;    ///< streams to try next, the first one last
  std::vector<std::string> elsewhere_;  ///< streams that others solve, those to look at next last
  std::vector<std::string> moving_;     ///< streams that wait for the end of an earlier motion
  std::size_t most_owned_;              ///< what RLIMIT_NOFILE allows
  std::vector<Watch> watches_;          ///< all that a sweep reads of an idle stream
  std::vector<Served> served_;          ///< likewise, index by index
  std::vector<std::size_t> calling_;    ///< of these, those that this sweep steps
  std::vector<ItemRefusal> refused_;    ///< scratch
  Time now_{};                          ///< of this sweep
  Time pause_;
  std::size_t quiet_sweeps_;  ///< of so many, one looks at a quiet stream
  std::size_t sweeps_ = 0;
  bool all_quiet_ = false;
  bool has_detached_ = false;
};

}  // namespace splinecast::ipc
