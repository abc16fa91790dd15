#pragma once

#include <memory>

#include "tests/campaign/streams/revision_check.hpp"
#include "tests/campaign/streams/simulated_producer.hpp"
#include "tests/campaign/streams/simulated_reader.hpp"
#include "tests/fixtures/streams/simulated_clock.hpp"

namespace splinecast::campaign {

/// A whole live stream: the real ring, board, solver and samplers in plain memory, with a simulated
/// producer and a simulated clock. The plan's seed determines everything.
class SimulatedStream {
 public:
  SimulatedStream(const StreamPlan& plan, StreamFindings& findings, Random& random);
  SimulatedStream(const SimulatedStream&) = delete;
  SimulatedStream& operator=(const SimulatedStream&) = delete;

  /// Runs the stream until it has finished and is at rest, or has broken a promise.
  void run();

 private:
  void advance_to(Time t);
  void read_now();
  void read_seldom();
  void poll();
  void check_kept_up(SampleStatus status);

  [[nodiscard]] bool is_over() const;
  void work();
  [[nodiscard]] bool settle_without_step();
  void step();
  void step_in_trouble();
  void step_and_die();
  void check_step(const StepResult& result, ipc::Word misses, ipc::Word late);
  void replace_solver();
  void schedule_solver();

  StreamPlan plan_;
  StreamFindings* findings_;
  Random* random_;
  Time now_{};
  testing::SimulatedClock clock_;
  testing::MemoryStream stream_;
  RevisionCheck check_;
  RevisionLog log_;
  SimulatedProducer producer_;
  SampleMemory settled_;
  SimulatedReader controller_;  ///< samples at now, every tick
  SimulatedReader seldom_;      ///< samples at now, with many revisions between samples
  SimulatedReader eager_;       ///< samples after the settled curve
  SimulatedReader previewer_;   ///< previews before and after now
  Time next_tick_{};
  Time next_seldom_{};
  Time next_poll_{};
  Time next_step_{};
  Time pace_{};                  ///< period of the solver's steps
  Time kept_up_until_{};         ///< the last steps must have settled the curve up to here
  bool has_taken_over_ = false;  ///< whether no revision has been committed since a takeover
  bool was_in_time_ = true;      ///< whether the last step committed without a delay
};

}  // namespace splinecast::campaign
