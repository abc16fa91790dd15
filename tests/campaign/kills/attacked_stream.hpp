#pragma once

#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "apps/process/child.hpp"
#include "splinecast/reader.hpp"
#include "tests/campaign/findings.hpp"
#include "tests/campaign/kills/curve_check.hpp"
#include "tests/campaign/kills/plan.hpp"
#include "tests/campaign/kills/ring_check.hpp"

namespace splinecast::campaign {

/// One stream with all of its processes. Kills processes, restarts them, measures the time until
/// new data can be sampled, and compares each life of the stream with its reference at its end.
class AttackedStream {
 public:
  /// Starts all processes.
  explicit AttackedStream(Plan plan);
  AttackedStream(const AttackedStream&) = delete;
  AttackedStream& operator=(const AttackedStream&) = delete;
  /// Kills the remaining processes and removes the stream.
  ~AttackedStream();

  [[nodiscard]] const Plan& plan() const noexcept { return plan_; }
  [[nodiscard]] Journal& journal() const noexcept { return *journal_; }
  [[nodiscard]] const Findings& findings() const noexcept { return findings_; }

  /// Polls all processes once. The interval between calls is the resolution of recovery times.
  void tick();

  /// Kills a running process. `which` is the index of a reader. Returns whether it was running.
  bool kill(Role role, std::size_t which = 0);

  /// At the end of this life of the stream, kills its solver and runs `rm`; kills `rm` if it still
  /// runs when `after` has passed. For recorded streams.
  void kill_remover_at_end(Time after) { removal_ = after; }

  /// Whether all processes run, and new data has been sampled since the last kill.
  [[nodiscard]] bool is_calm() const;

  /// Waits for the end of the stream, ends all processes and removes the stream. Returns the
  /// findings.
  Findings finish();

 private:
  struct Reading {
    std::optional<apps::Child> child;
    std::uint64_t turns = 0;
    Time moved{};  ///< when `turns` last changed
  };
  /// State when a writer was killed: another id or a larger count means new data.
  struct Mark {
    std::uint64_t stream_id = 0;
    ipc::Word count = 0;
  };

  void start_solver();
  void start_producer();
  void start_reader(std::size_t which);
  void observe();
  void reap();
  void reap(std::optional<apps::Child>& child, Role role);
  void note_kill(Role role);
  void note_recoveries(Time now);
  void restart();
  void watch(Time now);
  void count_hang(const std::string& what);
  [[nodiscard]] bool may_produce() const;
  void end_life();
  void count_items();
  void remove_at_end();
  void end(std::optional<apps::Child>& child);
  [[nodiscard]] bool tick_until(const std::function<bool()>& condition);
  void remove_files();
  [[nodiscard]] std::uint64_t observed_id() const;
  [[nodiscard]] std::optional<RingCheck> ring() const;

  Plan plan_;
  SharedJournal journal_;
  MonotonicClock clock_;
  std::optional<apps::Child> producer_;
  std::optional<apps::Child> solver_;
  std::list<apps::Child> dying_;  ///< solvers that were killed
  std::vector<Reading> readers_;
  std::size_t killed_reader_ = 0;
  std::optional<Reader> observer_;
  std::optional<CurveCheck> check_;
  ipc::Summary summary_;
  bool has_sampled_ = false;  ///< whether this tick has sampled the newest knot
  std::array<Mark, kRoles> marks_;
  std::uint64_t compared_id_ = 0;  ///< id of the last stream whose end was compared
  Mark progress_;
  Time moved_{};
  std::optional<Time> removal_;
  bool is_last_life_ = false;  ///< the next end of the stream is the last one
  bool is_ending_ = false;     ///< no process is started any more
  Findings findings_;
};

}  // namespace splinecast::campaign
