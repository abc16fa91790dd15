#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/process/child.hpp"
#include "splinecast/clock.hpp"
#include "tests/campaign/record/check.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::record {

/// One run: the recorder, the streams that it records, and an attack.
class Trial {
 public:
  Trial(const RunPlan& plan, Tally& tally);
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  /// Removes the streams.
  ~Trial();

  void run();

 private:
  void start_sources();
  void start_recorder();
  void attack();
  void kill();
  void pause();
  void slow_down();
  void fill();
  void interrupt();
  void rename_file();
  void trigger();
  void sleep(double least, double most);
  void collect();
  void await_attached();
  void end_recorder();
  void await_end();
  [[nodiscard]] bool has_time() const { return clock_.now() < end_; }

  const RunPlan& plan_;
  Tally& tally_;
  Random random_;
  MonotonicClock clock_;
  Folder folder_;
  Disk disk_;
  std::optional<Program> recorder_;
  std::vector<std::unique_ptr<apps::Child>> sources_;
  Time end_{};  ///< when the sources end
  bool is_attacked_ = false;
  Remains remains_;
};

}  // namespace splinecast::campaign::record
