#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "ipc/verification/settled_segments.hpp"
#include "tests/campaign/streams/curve_rules.hpp"
#include "tests/campaign/streams/findings.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::campaign {

/// Checks every revision of a simulated stream: the counters of the items, that the curve passes
/// through its waypoints, that it does not step, and that it ends at rest. Keeps the data for a
/// verification.
class RevisionCheck {
 public:
  RevisionCheck(const StreamPlan& plan, testing::MemoryStream& stream, StreamFindings& findings);

  /// Records the items that the producer has appended. Call it after each call of the producer.
  void note_items() { items_.note_items(stream_->ring.reader); }

  /// Checks the newest revision if it is new. Call it after each step of a solver; `now` is the
  /// step's first clock reading.
  void look(Time now, bool is_complete = true);

  /// Records a stop that the ring has accepted as this item. It takes effect in the next step.
  void expect_stop(ipc::Word item, Time t) {
    accepted_stop_ = Stop{.item = item, .time = t};
    findings_->count(Event::stops);
  }

  /// Call it before each step.
  void begin_step() {
    had_curve_ = summary_.newest > 0;
    if (accepted_stop_) due_stop_ = std::exchange(accepted_stop_, std::nullopt);
  }

  /// Checks that a due stop has taken effect. Call it after each step that was not discarded.
  void check_stop();

  /// Verifies the settled curve, if all of its segments were seen.
  void verify();

  /// The newest revision's summary.
  [[nodiscard]] const ipc::Summary& summary() const noexcept { return summary_; }
  /// The time at which the newest revision's curve is at rest.
  [[nodiscard]] Time end_of_motion() const noexcept { return end_; }
  [[nodiscard]] const ipc::SentItems& items() const noexcept { return items_.items(); }

 private:
  struct Pending {
    ipc::Word item = 0;
    Time time{};
  };
  struct Stop {
    ipc::Word item = 0;
    Time time{};
    int steps_due = 0;  ///< steps since its time that did not consume it
  };

  void check_counts(const ipc::Summary& before);
  [[nodiscard]] bool copy(ipc::Word number);
  void check_settled_until(const ipc::Summary& before, Time now);
  void count_events(const ipc::Summary& before);
  void take_items(const ipc::Summary& before);
  void forget_from(ipc::Word item);
  void check_passed(const ipc::Summary& before);
  void check_settled_segments();
  void check_waypoint_at(const ipc::SegmentCopy& segment);
  void check_last_waypoint(const ipc::SegmentCopy& segment);
  void check_end();
  void check_entry(const ipc::SegmentCopy& segment);
  void check_stop_segment(const ipc::SegmentCopy& segment);
  void check_verifiable();
  void breach(Breach breach, const std::string& what);

  const StreamPlan* plan_;
  testing::MemoryStream* stream_;
  StreamFindings* findings_;
  CurveRules rules_;
  testing::ItemRecord items_;
  ipc::SettledSegments settled_;
  std::size_t joined_ = 0;  ///< number of checked settled segments
  bool has_gap_ = false;    ///< a settled segment was overwritten before it was seen
  bool is_verifiable_ = true;
  ipc::Word passed_seen_ = 0;               ///< waypoints that were found to be passed over
  std::optional<ipc::Word> last_passed_{};  ///< the last of them
  std::optional<ipc::Word> last_taken_{};   ///< the last waypoint that was taken
  bool is_replaced_ = false;                ///< whether a replacement was taken
  std::deque<Pending> pending_;  ///< interpolated waypoints that have not settled, by time
  ipc::BoardSegment board_segment_;
  ipc::SegmentCopy copy_;
  ipc::Summary summary_;
  Time end_{};
  std::optional<Stop> accepted_stop_;
  std::optional<Stop> due_stop_;
  bool had_curve_ = false;  ///< whether a curve existed before the step
};

}  // namespace splinecast::campaign
