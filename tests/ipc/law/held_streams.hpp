#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "ipc/board/reader.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/verification/sent_items.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/ipc/law/time_law.hpp"

namespace splinecast::testing {

/// A stream of one dimension under a law, a sine of stream time, with a record of what was sent and
/// of what has settled. Checks each sample: one that was settled ahead of its time is the one that
/// is executed, and nothing that was executed changes.
class RecordedArm {
 public:
  RecordedArm(const std::string& law, const Clock& clock, double phase)
      : law_(law), clock_(clock), phase_(phase) {
    producer_.emplace(ipc::Internals::producer(
        stream_.name(), ProducerOptions{.clock = StreamClock::law, .law = law}, clock_));
    take_over();
  }

  /// Begins the path at a stream time.
  void begin(Time stream_time) { next_ = origin_ = stream_time; }

  /// A new solver continues the stream.
  void take_over() {
    solver_.reset();
    solver_.emplace(stream_.name(), SolverOptions{});
    EXPECT_TRUE(solver_->attach(clock_));
    if (!reader_) open();
  }

  /// One step of producer, solver, reader and record.
  void step(Time stream_now) {
    if (!is_stopped_) produce(stream_now + milliseconds(400));
    (void)solver_->step(clock_);
    settled_->look(follower_->final_until(clock_.now()));
    for (const ItemRefusal& refusal : producer_->refusals().items) items_.refuse(refusal.item);
    look();
  }

  /// Stops, without new waypoints until resume().
  void stop() {
    ASSERT_EQ(producer_->replace_from(Time::min(), {}), AppendStatus::accepted);
    items_.add(ipc::ItemKind::replace, {.time = Time::min()});
    is_stopped_ = true;
  }
  /// No waypoints any more.
  void starve() { is_stopped_ = true; }
  void resume(Time stream_time) {
    next_ = stream_time;
    is_stopped_ = false;
  }
  /// Replaces the path from earliest() and a margin on, by the same one with another phase.
  void redirect(double phase, Time margin = {}) {
    phase_ = phase;
    const Time begin = producer_->earliest() + margin;
    next_ = begin + milliseconds(200);
    std::array<std::array<double, 1>, 8> positions{};
    std::array<Waypoint, 8> waypoints{};
    for (std::size_t i = 0; i < waypoints.size(); ++i, next_ += kInterval) {
      positions[i] = {position(next_)};
      waypoints[i] = {.time = next_, .position = positions[i]};
    }
    ASSERT_EQ(producer_->replace_from(begin, waypoints), AppendStatus::accepted);
    items_.add(ipc::ItemKind::replace, {.time = begin});
    for (const Waypoint& waypoint : waypoints) items_.add(ipc::ItemKind::waypoint, waypoint);
    is_stopped_ = false;
  }

  [[nodiscard]] double x() const noexcept { return last_.position()[0]; }
  [[nodiscard]] double v() const noexcept { return last_.velocity()[0]; }
  [[nodiscard]] Reader& reader() noexcept { return *reader_; }
  [[nodiscard]] Producer& producer() noexcept { return *producer_; }
  [[nodiscard]] const std::string& name() const noexcept { return stream_.name(); }
  [[nodiscard]] std::span<const ipc::SegmentCopy> segments() const { return settled_->segments(); }
  [[nodiscard]] bool begins_from_rest() {
    const auto begin = producer_->replacement_begin();
    return begin && begin->from_rest;
  }

  /// Solves the record again.
  [[nodiscard]] ipc::Verification verify() const {
    return ipc::verify({.window = ipc::window_options(board_->header),
                        .kinds = ipc::dimension_kinds(board_->header),
                        .items = items_,
                        .segments = settled_->segments(),
                        .summary = settled_->summary(),
                        .end = {}});
  }

 private:
  void open() {
    board_.emplace(ipc::open_board(stream_.name(), false, {}));
    knots_.emplace(board_->region.bytes(), board_->layout);
    settled_.emplace(*knots_, true);
    follower_ = std::make_unique<ipc::LawFollower>(board_->header, Trust{});
    reader_.emplace(stream_.name());
  }
  [[nodiscard]] double position(Time stream_time) const {
    return std::sin(4 * to_seconds(stream_time - origin_) + phase_);
  }
  void produce(Time until) {
    for (; next_ < until; next_ += kInterval) {
      const std::array x{position(next_)};
      const Waypoint waypoint{.time = next_, .position = x};
      ASSERT_EQ(producer_->append(waypoint), AppendStatus::accepted);
      items_.add(ipc::ItemKind::waypoint, waypoint);
    }
  }
  void look() {
    const Time now = clock_.now();
    const SampleStatus status = reader_->sample(now, last_);
    if (!has_values(status)) return;
    EXPECT_NE(status, SampleStatus::revised);
    if (const auto known = ahead_.find(now); known != ahead_.end()) {
      EXPECT_EQ(known->second[0], x());
      EXPECT_EQ(known->second[1], v());
    }
    ahead_.erase(ahead_.begin(), ahead_.upper_bound(now));
    State then(1);
    for (int i = 1; i < 6; ++i) {
      const Time t = now + milliseconds(i);
      if (reader_->preview(t, then) != SampleStatus::settled) continue;
      const std::array values{then.position()[0], then.velocity()[0]};
      const auto [place, is_new] = ahead_.try_emplace(t, values);
      if (!is_new) {
        EXPECT_EQ(place->second, values);
      }
    }
  }

  TestStream stream_;
  std::string law_;
  const Clock& clock_;
  double phase_;
  bool is_stopped_ = false;
  Time origin_{};
  Time next_{};
  std::optional<Producer> producer_;
  std::optional<Solver> solver_;
  std::optional<Reader> reader_;
  std::optional<ipc::CheckedRegion<ipc::BoardLayout>> board_;
  std::optional<ipc::KnotBoardReader> knots_;
  std::optional<ipc::SettledSegments> settled_;
  std::unique_ptr<ipc::LawFollower> follower_;
  ipc::SentItems items_{1};
  State last_{1};
  std::map<Time, std::array<double, 2>> ahead_;  ///< settled samples of times ahead
};

/// Two streams that follow one law.
class HeldStreams : public ::testing::Test {
 protected:
  HeldStreams() {
    operator_.set_rate(1, milliseconds(10));
    start_law();
    pass_law(milliseconds(50));
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      arms_[i] = std::make_unique<RecordedArm>(law_.name(), clock_, static_cast<double>(i));
      arms_[i]->begin(stream_now() + milliseconds(300));
    }
    pass(milliseconds(700));
  }

  void start_law() {
    law_solver_.emplace(law_.name(), SolverOptions{});
    EXPECT_TRUE(law_solver_->attach(clock_));
  }
  void pass_law(Time time) {
    for (const Time end = clock_.now() + time; clock_.now() < end;) {
      clock_.advance(milliseconds(1));
      (void)law_solver_->step(clock_);
    }
  }
  void pass(Time time, Time step = milliseconds(1)) {
    for (const Time end = clock_.now() + time; clock_.now() < end;) {
      clock_.advance(step);
      if (law_solver_) (void)law_solver_->step(clock_);
      for (const auto& arm : arms_) arm->step(stream_now());
    }
  }
  void hold(Time ramp) { operator_.set_rate(0, ramp); }
  void go(Time ramp) { operator_.set_rate(1, ramp); }

  [[nodiscard]] Time stream_now() {
    if (!law_reader_) law_reader_.emplace(law_.name());
    State state(1);
    EXPECT_TRUE(has_values(law_reader_->preview(clock_.now(), state)));
    rate_ = state.velocity()[0];
    return Time(ipc::Internals::header(*law_reader_).law_origin) +
           Time(static_cast<std::int64_t>(state.position()[0] * 1e9));
  }
  /// The law's rate at the last step.
  [[nodiscard]] double rate() const noexcept { return rate_; }
  [[nodiscard]] RecordedArm& arm(std::size_t i = 0) noexcept { return *arms_[i]; }

  TestStream law_;
  HostClock clock_;
  RateCommander operator_{law_.name(), "operator"};
  std::optional<Solver> law_solver_;
  std::array<std::unique_ptr<RecordedArm>, 2> arms_;
  std::optional<Reader> law_reader_;
  double rate_ = 0;
};

}  // namespace splinecast::testing
