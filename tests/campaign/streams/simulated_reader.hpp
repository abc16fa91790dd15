#pragma once

#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "tests/campaign/streams/findings.hpp"
#include "tests/campaign/streams/revision_log.hpp"

namespace splinecast::campaign {

/// Samples that are read again later: a bounded random choice of the offered ones.
class SampleMemory {
 public:
  SampleMemory(std::size_t size, std::size_t dimensions);

  struct Seen {
    Time time{};
    std::vector<double> values;
  };
  void offer(Time t, const State& state, Random& random);
  void clear() noexcept { used_ = 0; }
  [[nodiscard]] std::span<const Seen> seen() const { return std::span(seen_).first(used_); }

 private:
  std::vector<Seen> seen_;
  std::size_t used_ = 0;
};

/// One reader of a simulated stream, which checks its samples.
class SimulatedReader {
 public:
  SimulatedReader(const ipc::KnotBoardReader& board, const StreamPlan& plan, RevisionLog& log,
                  StreamFindings& findings, Random& random);

  /// Samples like a controller. Offers settled samples to `settled`.
  SampleStatus sample(Time t, SampleMemory& settled);

  /// Previews the curve at a time before or after now.
  SampleStatus preview(Time t, SampleMemory& settled);

  [[nodiscard]] Time settled_until() const noexcept { return sampler_.settled_until(); }
  /// Whether a sample has had values.
  [[nodiscard]] bool has_read() const noexcept { return has_read_; }

 private:
  [[nodiscard]] bool is_open_start(Time t) const;
  void judge_revised(Time t, bool is_revised);
  void note_revisions(ipc::Word seen);
  void read_executed_again();
  void check_values(Time t, SampleStatus status, SampleMemory& settled);

  const StreamPlan* plan_;
  StreamFindings* findings_;
  Random* random_;
  RevisionLog* log_;
  ipc::Sampler sampler_;
  State state_;
  State again_;
  SampleMemory executed_;  ///< since the last `revised`
  Time sampled_until_ = Time::min();
  Time settled_until_seen_ = Time::min();  ///< `settled_until` of the last revision seen
  bool may_be_revised_ = false;
  bool has_read_ = false;
};

/// Reads settled samples again with a new reader.
void read_settled_again(const ipc::KnotBoardReader& board, const StreamPlan& plan,
                        const SampleMemory& settled, StreamFindings& findings);

}  // namespace splinecast::campaign
