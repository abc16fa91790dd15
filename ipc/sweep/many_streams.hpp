#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/memory/poll_schedule.hpp"
#include "ipc/memory/region_watch.hpp"
#include "ipc/roles/solver_watch.hpp"
#include "ipc/sweep/news.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::ipc {

/// The solvers of many streams in one thread. The streams are named, or found by patterns as they
/// come and go.
///
/// A sweep polls one cache line of each stream and steps the streams that have work to do. It polls
/// a stream that has been idle for a second only every 20 ms, in turn with other idle streams,
/// because such a poll misses the caches for that line and its page. It reads which regions have
/// come and gone, so that the law of a new commander, and the stream of a new stopper, is stepped
/// at once. Every 50 ms it also looks for new streams, and for wanted streams whose solver in
/// another process has died. A sweep attaches to at most one stream, because that maps memory, and
/// the others must not wait long. Allocates only when streams come and go.
class StreamSweep {
 public:
  /// Each of `wanted` is a stream's name or a pattern, see is_pattern(). From now on no other
  /// process can solve a named stream, even while it has no producer. Solves all streams with these
  /// options. Throws BadRequest for invalid options or names. The constructor may already call
  /// `notify`. `pause` is the time between two sweeps.
  StreamSweep(const std::vector<std::string>& wanted, SolverOptions options, NotifyNews notify,
              Time pause = std::chrono::milliseconds(1));

  /// Polls every stream once. Returns whether one of them still has work to do: sweep again at
  /// once. A stream that fails is given up or postponed; the others continue.
  bool sweep(const Clock& clock);

  /// The time to wait before the next sweep: `pause`, or PollSchedule::kIdlePause if that is longer
  /// and all streams are idle. The next sweep then polls all of them.
  [[nodiscard]] Time next_pause() const noexcept { return schedule_.next_pause(); }

  /// Number of streams that are solved here.
  [[nodiscard]] std::size_t solved() const noexcept { return served_.size(); }

  /// File descriptors that a stream takes while it is solved: the lock and the board.
  static constexpr std::size_t kDescriptorsPerStream = 2;

 private:
  /// Maximum number of streams tried in one sweep, and of streams that were given up, or are of
  /// other processes, checked in one call. When one of the last has lost its solver, the count
  /// restarts, because the same process usually solved the others too.
  static constexpr std::size_t kTries = 16;

  /// Interval between retries of postponed streams, one stream per retry. After a success, the next
  /// poll retries another one without this interval.
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

  /// Inodes of the ring, of the board, and of its lock file if another user owns that; 0: none.
  using Files = std::array<std::uint64_t, 3>;

  struct Member {
    bool is_named = false;
    State state = State::unowned;
    std::unique_ptr<Solver> waiting{};  ///< holds the lock until the stream can be solved
    Files files{};                      ///< its files when it was given up
  };

  struct Served {
    std::unique_ptr<Solver> solver;
    ReportedNews news{};
    std::exception_ptr failure{};  ///< of a step
  };

  /// What a sweep reads of a stream without work.
  struct Watch {
    SolverWatch solver;
    Time active;  ///< when it was last stepped
  };

  // Which streams are wanted and ready: discovery.cpp.
  void poll();
  void list_found_streams();
  [[nodiscard]] bool is_wanted(const std::string& stream) const;
  [[nodiscard]] static bool is_to_be_tried(const Member& member) noexcept;
  [[nodiscard]] static Files files_of(const std::string& stream);
  void retry_given_up();
  void note_ends_of_motion();
  void check_elsewhere();
  void retry_postponed();

  // Attaching to streams, and giving them up: taking_up.cpp.
  void attach_next(const Clock& clock);
  [[nodiscard]] bool own(const std::string& stream, Member& member);
  [[nodiscard]] bool attach(const std::string& stream, Member& member, const Clock& clock);
  void make_room();
  void hold_regions() noexcept;
  void release(Served& served);
  void drop(const std::string& stream, Member& member, const std::exception& error);

  // Stepping those that have work to do: stepping.cpp.
  void attach_waiting(const Clock& clock);
  void collect_calling();
  void prefetch_next(std::size_t i) const noexcept;
  [[nodiscard]] bool serve(std::size_t index, const Clock& clock);
  void release_detached();

  // States and reports.
  void become(const std::string& stream, Member& member, State state, SweepNews news,
              const Solver* solver = nullptr, std::string_view why = {}) noexcept;
  void notify(SweepNews news, const std::string& stream, const Solver* solver,
              std::string_view why) noexcept;
  [[nodiscard]] std::size_t owned() const noexcept;

  SolverOptions options_;
  NotifyNews notify_;
  std::vector<std::string> patterns_;
  RegionWatch regions_;
  std::optional<Word> seen_{};  ///< version of regions_ when the names were listed last
  std::map<std::string, Member> members_;
  Time next_poll_ = Time::min();
  bool must_list_again_ = false;  ///< the next poll lists the names even if the folder is unchanged
  Time next_retry_ = Time::min();
  std::string last_retried_;            ///< the postponed stream that was retried last
  bool is_any_unheld_ = false;          ///< whether a board may lack its region lock
  std::vector<std::string> to_attach_;  ///< streams to try next, in reverse order
  std::vector<std::string> given_up_;   ///< streams whose files may have been replaced
  std::vector<std::string> elsewhere_;  ///< streams of other processes to check, in reverse order
  std::vector<std::string> moving_;     ///< streams that wait for the end of an earlier motion
  std::size_t most_owned_;              ///< the maximum that RLIMIT_NOFILE allows
  std::vector<Watch> watches_;          ///< all that a sweep reads of an idle stream
  std::vector<Served> served_;          ///< the same streams, with the same indices
  std::vector<std::size_t> calling_;    ///< indices of the streams that this sweep steps
  ReportedNews::Scratch scratch_;
  Time now_{};  ///< time of this sweep
  PollSchedule schedule_;
  Word stoppers_ = 0;  ///< version of the stoppers when all streams were polled last
  bool has_detached_ = false;
};

}  // namespace splinecast::ipc
