#pragma once

#include <functional>
#include <vector>

#include "ipc/ring/item.hpp"
#include "ipc/ring/writer.hpp"
#include "tests/campaign/streams/revision_check.hpp"
#include "tests/campaign/streams/waypoint_source.hpp"

namespace splinecast::campaign {

/// The producer of a simulated stream. It sends waypoints in time or late, pauses, replaces the
/// future, makes invalid calls, dies, and finishes.
class SimulatedProducer {
 public:
  SimulatedProducer(const StreamPlan& plan, testing::MemoryStream& stream, RevisionCheck& check,
                    StreamFindings& findings, Random& random);

  /// Time of its next action.
  [[nodiscard]] Time next() const noexcept { return next_; }

  void act(Time now);

  [[nodiscard]] bool has_finished() const { return stream_->ring.writer.finished(); }

 private:
  enum class Phase { steady, jittered, late, silent, burst };

  void start(Time now);
  void change_phase(Time now);
  void send_due(Time now);
  void send_next();
  void do_something_else(Time now);
  void replace(Time now);
  void stop(Time now);
  [[nodiscard]] Time replacement_time(Time now);
  void make_mistake(Time now);
  void replace_too_many(Time now);
  void die(Time now);
  void finish(Time now);
  void observe();
  [[nodiscard]] ipc::WaypointRingWriter::Solved solved();
  AppendStatus answered(AppendStatus status);

  const StreamPlan* plan_;
  testing::MemoryStream* stream_;
  RevisionCheck* check_;
  StreamFindings* findings_;
  Random* random_;
  Random blends_;  ///< separate, so that blends do not change the rest of a seed's stream
  WaypointSource source_;
  ipc::RingItem observed_;
  Phase phase_ = Phase::steady;
  Time phase_end_{};
  Time next_{};
  Time next_waypoint_{};
  Time lead_{};
  Time last_sent_{};  ///< time of the last accepted waypoint
  bool is_full_ = false;
  bool has_started_ = false;
};

}  // namespace splinecast::campaign
