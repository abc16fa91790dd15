#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

namespace splinecast::ipc::entries {

using std::chrono::milliseconds;
using testing::LiveStream;

/// The end condition of the streams.
inline constexpr Condition kHalt{.kind = ConditionKind::halt, .value = {}};

/// A motion that begins at rest 50 ms after the start. Its maxima are 1 /s and 1 /s².
inline double motion(Time t) {
  const double s = to_seconds(t - LiveStream::kNow) - 0.05;
  return 0.5 * s - 0.25 * std::sin(2 * s);
}

/// The time `ms` after the start.
inline Time at(int ms) { return LiveStream::kNow + milliseconds(ms); }

/// Options with an acceleration limit; 0 means no limit.
inline core::WindowOptions limited(double acceleration) {
  core::WindowOptions how;
  how.limits.acceleration = {acceleration};
  return how;
}

/// A live stream that records its curve, items and refusals.
struct Watched : LiveStream {
  struct Sent {
    Time time{};
    double position = 0;
  };

  explicit Watched(core::WindowOptions how = {}, bool takes_over = false)
      : LiveStream(std::move(how), 1024, {.history = std::chrono::seconds(2)}),
        items(1),
        collected(board.reader, true),
        takes_over_each_step(takes_over) {}

  void step() {
    note();
    if ((takes_over_each_step && !is_searching) || clock.time >= takes_over_at) {
      replace_solver();
      takes_over_at = Time::max();
    }
    const Summary before = solver.summary();
    solver.step(clock);
    EXPECT_LE(solver.summary().revision, before.revision + 1);
    // Only a revision that takes a replacement withdraws items.
    EXPECT_TRUE(solver.summary().withdrawn == before.withdrawn ||
                solver.summary().controls > before.controls);
    is_searching = solver.due() <= clock.time;
    note();
    const Summary& summary = solver.summary();
    EXPECT_EQ(summary.consumed,
              summary.knots + summary.refused + summary.withdrawn + summary.controls);
    EXPECT_LE(summary.passed_over, summary.knots);
  }
  void note() {
    items.note_items(ring.reader);
    items.note_refusals(board.reader, solver.summary().refused);
    collected.look();
  }
  void run_to(int ms) {
    for (; clock.time < at(ms); clock.time += milliseconds(1)) step();
  }
  /// Sends a waypoint without the checks that depend on the settled time.
  void send(int ms, double position) {
    ASSERT_EQ(
        ring.writer.append({.time = at(ms), .position = {&position, 1}}, {board.reader.consumed()}),
        AppendStatus::accepted)
        << ms;
    sent.push_back({at(ms), position});
  }
  void send(int ms) { send(ms, motion(at(ms))); }
  /// Sends a waypoint every 10 ms, each one `lead` ms before its time. Advances the clock.
  void send_all(int from_ms, int to_ms, int lead) {
    for (int ms = from_ms; ms <= to_ms; ms += 10) {
      run_to(ms - lead);
      send(ms);
    }
    step();
  }
  void end() {
    while (ring.writer.finish(kHalt, {board.reader.consumed()}) == AppendStatus::full) step();
    for (int i = 0; i < 5000 && !solver.summary().finished; ++i) {
      step();
      clock.time += milliseconds(1);
    }
    ASSERT_TRUE(solver.summary().finished);
    note();
  }
  [[nodiscard]] std::string verified() {
    const Verification found = verify({.window = window,
                                       .kinds = kinds,
                                       .items = items.items(),
                                       .segments = collected.segments(),
                                       .summary = collected.summary(),
                                       .end = kHalt});
    if (!found.first) return found.equal > 0 ? "" : "nothing was compared";
    return std::to_string(found.first->segment) + ": " + found.first->what + ", " +
           found.first->published + " published, " + found.first->solved + " solved";
  }
  /// The number of sent waypoints that the curve interpolates at their time, or slowed down later,
  /// or ends at.
  [[nodiscard]] Word met() const {
    Word count = 0;
    for (const Sent& waypoint : sent) count += is_met(waypoint) || ends_at(waypoint) ? 1U : 0U;
    return count;
  }
  [[nodiscard]] bool is_met(const Sent& waypoint) const {
    return std::ranges::any_of(collected.segments(), [&](const SegmentCopy& s) {
      const double begin = s.has_waypoint ? s.waypoint[0] : s.coefficients[0];
      const bool is_late = s.kind == SegmentKind::slowed && s.left > waypoint.time;
      return (s.left == waypoint.time || is_late) && begin == waypoint.position;
    });
  }
  /// Separate check for the last waypoint, because no segment begins at the end of the curve.
  [[nodiscard]] bool ends_at(const Sent& waypoint) const {
    const SegmentCopy& last = collected.segments().back();
    State end(1);
    core::evaluate(last.order, last.coefficients, to_seconds(last.right - last.left), end.ref());
    return waypoint.time == sent.back().time &&
           std::abs(end.position()[0] - waypoint.position) < 1e-9;
  }
  /// The largest derivative on segments that the solver chooses: entries, stop segments and holds.
  [[nodiscard]] double peak(int derivative) const { return peak(derivative, false); }
  /// The same, on request also on the spline through the waypoints.
  [[nodiscard]] double peak(int derivative, bool counts_spline) const {
    State at(1);
    double most = 0;
    for (const SegmentCopy& s : collected.segments()) {
      if (!counts_spline && s.kind == SegmentKind::spline && s.has_waypoint) continue;
      const double h = to_seconds(s.right - s.left);
      for (int i = 0; i <= 50; ++i) {
        core::evaluate(s.order, s.coefficients, h * i / 50, at.ref());
        const auto values = derivative == 1 ? at.velocity() : at.acceleration();
        most = std::max(most, std::abs(values[0]));
      }
    }
    return most;
  }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(
        std::ranges::count(collected.segments(), SegmentKind::entry, &SegmentCopy::kind));
  }
  [[nodiscard]] EndKind ending() const { return solver.summary().ending(); }
  [[nodiscard]] Course course() const { return static_cast<Course>(solver.summary().course); }

  std::vector<Sent> sent;
  testing::ItemRecord items;
  SettledSegments collected;
  bool takes_over_each_step;  ///< except in a search, which a new solver would restart
  bool is_searching = false;
  Time takes_over_at = Time::max();  ///< one takeover at this time
};

/// Expects position and velocity to be continuous from each segment to the next.
inline void expect_continuous(const Watched& live) {
  const auto segments = live.collected.segments();
  State left(1);
  State right(1);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const SegmentCopy& before = segments[i - 1];
    ASSERT_EQ(before.right, segments[i].left);
    ASSERT_EQ(before.next, segments[i].number);
    core::evaluate(before.order, before.coefficients, to_seconds(before.right - before.left),
                   left.ref());
    core::evaluate(segments[i].order, segments[i].coefficients, 0, right.ref());
    EXPECT_NEAR(left.position()[0], right.position()[0], 1e-11);
    EXPECT_NEAR(left.velocity()[0], right.velocity()[0], 1e-9);
  }
}

}  // namespace splinecast::ipc::entries
