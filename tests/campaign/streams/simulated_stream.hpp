#pragma once

#include <memory>

#include "tests/campaign/streams/revision_check.hpp"
#include "tests/campaign/streams/simulated_producer.hpp"
#include "tests/campaign/streams/simulated_reader.hpp"
#include "tests/fixtures/streams/simulated_clock.hpp"

namespace splinecast::campaign {

/// One live stream, all of it: the real ring, board, solver and samplers in plain memory, with a
/// producer and a clock that are simulated. Everything that happens follows from the plan's seed.
class SimulatedStream {
 public:
  SimulatedStream(const StreamPlan& plan, StreamFindings& findings, Random& random);
  SimulatedStream(const SimulatedStream&) = delete;
  SimulatedStream& operator=(const SimulatedStream&) = delete;

  /// Lets it go on until it has finished and rests, or has broken a promise.
  void run();

 private:
  void advance_to(Time t);
  void read_now();
  void read_seldom();
  void look_around();
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
  SimulatedReader seldom_;      ///< samples at now, many revisions later
  SimulatedReader eager_;       ///< samples ahead of what has settled
  SimulatedReader previewer_;   ///< looks ahead and back
  Time next_tick_{};
  Time next_seldom_{};
  Time next_look_{};
  Time next_step_{};
  Time pace_{};                  ///< between two steps of the solver
  Time kept_up_until_{};         ///< up to which the last steps have settled the curve
  bool has_taken_over_ = false;  ///< no revision has been committed since
  bool was_in_time_ = true;      ///< the last revision was committed when its step began
};

}  // namespace splinecast::campaign
