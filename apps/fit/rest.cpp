#include "apps/fit/rest.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/limits/check.hpp"
#include "core/limits/position_range.hpp"
#include "core/motion/entry_search.hpp"
#include "core/motion/shown_limits.hpp"
#include "core/motion/slowed_path.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

using ipc::EndKind;

/// An end may begin at one of this number of last knots.
constexpr std::size_t kMostKnots = 1024;

core::SegmentPart part(const PiecewisePolynomial& curve, std::size_t i) {
  return {.order = curve.order_of(i),
          .coefficients = curve.coefficients(i),
          .dimensions = curve.dimensions(),
          .from = 0,
          .to = curve.seconds(i)};
}

/// The first `segments` segments of a curve.
PiecewisePolynomial head_of(const PiecewisePolynomial& curve, std::size_t segments) {
  PiecewisePolynomial head(curve.dimensions());
  for (std::size_t i = 0; i < segments; ++i) {
    head.append(curve.left_of(i), curve.right_of(i), curve.order_of(i), curve.coefficients(i));
  }
  return head;
}

/// Searches for the end of one curve. A knot is the left end of a segment of the path, or the last
/// waypoint.
class RestSearch {
 public:
  RestSearch(const PiecewisePolynomial& path, const Waypoints& waypoints, const RestRules& rules)
      : path_(path),
        rules_(rules),
        shown_(path.dimensions()),
        limits_(rules.limits),
        search_(path.dimensions(), rules.kinds),
        range_(path.dimensions()),
        state_(path.dimensions()),
        rest_(path.dimensions()),
        piece_(path.dimensions()) {
    const std::size_t dimensions = path.dimensions();
    for (std::size_t i = 0; i < waypoints.size(); ++i) {
      shown_.note(waypoints.times[i], waypoints.positions.subspan(i * dimensions, dimensions));
    }
    shown_.look(rules.stop_length);
    limits_.acceleration.resize(dimensions);
    search_.write_accelerations(rules.limits, shown_.limits(), limits_.acceleration);
    path.evaluate(last(), rest_.ref());
    std::ranges::fill(rest_.ref().velocity, 0.0);
    std::ranges::fill(rest_.ref().acceleration, 0.0);
    oldest_ = path.segments() - std::min(path.segments() - 1, kMostKnots);
  }

  [[nodiscard]] bool takes(const PiecewisePolynomial& halted, std::size_t open) const {
    const std::size_t n = path_.segments();
    for (std::size_t i = n - std::min(n, open); i < n; ++i) {
      const core::SegmentPart own = part(halted, i);
      if (!core::keeps_within(limits_, &rules_.kinds, own) &&
          !core::exceeds_no_more(limits_, &rules_.kinds, own, part(path_, i))) {
        return false;
      }
    }
    return true;
  }

  /// The curve that slows down on the path from the latest knot that passes.
  std::optional<FittedCurve> slowed() {
    range_.restart(rest_.position());
    for (std::size_t k = path_.segments() - 1; k >= oldest_; --k) {
      range_.add(part(path_, k));
      const core::SlowedPath slowed = slowed_from(k);
      if (!is_time_in_range(slowed.slowing().end_time()) || !passes(slowed, k)) continue;
      PiecewisePolynomial curve = head_of(path_, k);
      for (std::size_t i = 0; i + 1 < slowed.knots(); ++i) {
        slowed.build(i, piece_);
        core::append(piece_, curve);
      }
      return FittedCurve{std::move(curve), EndKind::slowed, slowed.slowing().end_time() - last()};
    }
    return std::nullopt;
  }

  /// The curve that leaves the path at the latest knot from which an entry to the last waypoint
  /// passes.
  std::optional<FittedCurve> entered() {
    range_.restart(rest_.position());
    const splinecast::Instant rest{last(), rest_.position(), rest_.velocity(),
                                   rest_.acceleration()};
    for (std::size_t k = path_.segments() - 1; k >= oldest_; --k) {
      range_.add(part(path_, k));
      const Time t = path_.left_of(k);
      path_.evaluate(t, state_.ref());
      const splinecast::Instant from{t, state_.position(), state_.velocity(),
                                     state_.acceleration()};
      const core::EntryRules entry{.limits = &rules_.limits,
                                   .shown = &shown_.limits(),
                                   .least = ipc::LiveOptions{}.least_entry,
                                   .reach = &range_};
      int tries = std::numeric_limits<int>::max();
      search_.restart(0);
      const auto outcome =
          search_.search_rest(rest, from, entry, core::EntrySearch::kLongest, tries);
      if (outcome != core::EntrySearch::Outcome::found) continue;
      PiecewisePolynomial curve = head_of(path_, k);
      core::append(search_.entry(), curve);
      return FittedCurve{std::move(curve), EndKind::entered, search_.end().state.time - last()};
    }
    return std::nullopt;
  }

  /// The path, and after it the shortest stop within the limits of acceleration and jerk.
  FittedCurve stopped() {
    path_.evaluate(last(), state_.ref());
    core::align_rotations(rules_.kinds, state_.velocity(), state_.ref().acceleration);
    const splinecast::Instant from{last(), state_.position(), state_.velocity(),
                                   state_.acceleration()};
    Time length = core::stop_time_within({rules_.limits, rules_.kinds, rules_.stop_length}, from);
    const auto& given = rules_.limits.acceleration;
    if (std::ranges::any_of(given, [](double limit) { return limit > 0; })) {
      length = std::min(length, core::stop_time_within({limits_, rules_.kinds, Time(1)}, from));
    }
    core::build_stop(last(), length, from.position, from.velocity, from.acceleration, piece_);
    PiecewisePolynomial curve = path_;
    core::append(piece_, curve);
    return {std::move(curve), EndKind::stopped, Time::zero()};
  }

 private:
  [[nodiscard]] Time last() const { return path_.breaks().back(); }

  /// The path from knot k ≥ 1 on.
  core::SlowedPath slowed_from(std::size_t k) {
    core::SlowedPath slowed(path_.dimensions());
    const core::SegmentPart before = part(path_, k - 1);
    core::evaluate_derivative(before.order, before.coefficients, before.to, 2, slowed.reached());
    for (std::size_t i = k; i < path_.segments(); ++i) {
      slowed.add(knot_at(path_.left_of(i)), part(path_, i));
    }
    slowed.add_last(knot_at(last()));
    return slowed;
  }

  /// Valid until the next call.
  core::Knot knot_at(Time t) {
    path_.evaluate(t, state_.ref());
    core::Knot knot{};
    knot.time = t;
    knot.waypoint = knot.position = state_.position();
    knot.velocity = state_.velocity();
    return knot;
  }

  [[nodiscard]] bool passes(const core::SlowedPath& slowed, std::size_t first) {
    const std::size_t pieces = path_.segments() - first;
    // First where the rate falls fastest: a knot that does not pass mostly fails there.
    const std::size_t steepest = pieces * 13 / 16;
    for (std::size_t i = 0; i < pieces; ++i) {
      const std::size_t piece = (steepest + i) % pieces;
      const core::SegmentPart on_path = part(path_, first + piece);
      slowed.build(piece, piece_);
      const bool passes =
          piece_.left < piece_.right && core::keeps_length(rules_.kinds, piece_) &&
          core::stays_near(slowed.slowing(), piece_, on_path, path_.left_of(first + piece),
                           range_) &&
          core::exceeds_no_more(limits_, &rules_.kinds, core::part_of(piece_), on_path);
      if (!passes) return false;
    }
    return true;
  }

  const PiecewisePolynomial& path_;
  const RestRules& rules_;
  core::ShownLimits shown_;
  MotionLimits limits_;  ///< with the accelerations of dimensions that have no limit
  core::EntrySearch search_;
  core::PositionRange range_;  ///< of the path from the knot that is tried
  State state_;                ///< scratch
  State rest_;
  core::Segment piece_;  ///< scratch
  std::size_t oldest_;   ///< ≥ 1: knot from which on an end may begin
};

}  // namespace

FittedCurve rest_at_last(const PiecewisePolynomial& halted, const PiecewisePolynomial& path,
                         const Waypoints& waypoints, const RestRules& rules, std::size_t open) {
  if (halted.is_hold()) return {halted, EndKind::as_requested, Time::zero()};
  RestSearch search(path, waypoints, rules);
  if (search.takes(halted, open)) return {halted, EndKind::as_requested, Time::zero()};
  if (auto slowed = search.slowed()) return *std::move(slowed);
  if (auto entered = search.entered()) return *std::move(entered);
  return search.stopped();
}

}  // namespace splinecast::apps
