#include "ipc/roles/law_server.hpp"

#include <algorithm>
#include <chrono>
#include <span>

#include "core/laws/law_path.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "splinecast/method.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {
namespace {

constexpr Time kPollInterval = std::chrono::milliseconds(20);

/// A law begins this long after its ring has been made: its solver must publish it before.
constexpr Time kNotice = std::chrono::milliseconds(20);

/// Accelerations beyond any ramp. With this limit an entry is not compared with the motion that the
/// law has shown, and ends at the first waypoint after it.
constexpr double kAboveAnyRamp = 1e12;

void describe_law(RegionHeader& header) {
  header.is_law = 1;
  header.law_origin = MonotonicClock().now().count();
}

ProducerOptions ring_options(const SolverOptions& options) {
  return {.names = {"stream time"},
          .units = {"s"},
          .start = {.kind = ConditionKind::own, .value = {}},
          .limits = {.min_interval = Time(1), .max_interval = kLatestTime / 2},
          .access = options.access,
          .trust = options.trust};
}

}  // namespace

bool LawServer::is_wanted(const std::string& law, const RegionWatch& watch) {
  return !watch.commanders().names_of(law).empty() && !is_owned(law, RegionKind::waypoints);
}

SolverOptions LawServer::solver_options(const SolverOptions& options) {
  return {.method = find_method("quintic"),
          .limits = MotionLimits{.acceleration = {kAboveAnyRamp}},
          .freeze_ahead = options.freeze_ahead,
          .history = options.history,
          .min_entry = Time(1),
          .largest_rate = options.largest_rate,
          .wake = options.wake,
          .access = options.access,
          .trust = options.trust};
}

LawServer::LawServer(const std::string& law, const SolverOptions& options, const RegionWatch& watch)
    : lock_(law, RegionKind::waypoints),
      ring_(own_ring(law, ring_options(options), lock_,
                     [&](RegionHeader& header) {
                       describe_law(header);
                       header.largest_rate = options.largest_rate.value_or(1.0);
                     })),
      commanders_(law, options.trust, watch),
      rate_(max_rate(ring_.header)) {
  lock_.keep_file();
  commanders_.poll();
}

void LawServer::attach(const KnotBoardReader& board, const RegionHeader& header) {
  board_ = &board;
  sampler_.emplace(board, StreamClock::monotonic);
  freeze_ahead_ = Time(header.freeze_ahead);
}

WaypointRingWriter::Solved LawServer::solved() const noexcept {
  return {.consumed = board_->consumed(), .settled_until = board_->look().settled_until};
}

/// Begins the law at the requested rate: one replacement with two waypoints, which the solver takes
/// in the same revision.
LawPlan LawServer::begin(Time now, Time settled) noexcept {
  const double rate = rate_.plan_beginning(commanders_);
  const Time start = std::max(now + std::max(kNotice, 2 * freeze_ahead_), settled + Time(1));
  core::LawPath path({.time = start,
                      .position = to_seconds(start - Time(ring_.header.law_origin)),
                      .rate = rate,
                      .slope = 0});
  path.add_begin();
  path.add_line();
  const AppendStatus status =
      ring_.writer.replace_from(start - Time(1), path.waypoints(), solved());
  if (status != AppendStatus::accepted) return {};
  planned_at_ = board_->revision();
  sent_ = path.waypoints().back().time;
  return {.table = rate_.table(), .must_commit = true};
}

std::optional<core::LawState> LawServer::state_at(Time time) noexcept {
  return law_state_at(*sampler_, time, max_rate(ring_.header), state_);
}

bool LawServer::read_newest() noexcept {
  return board_->copy_newest_summary(summary_) && summary_.newest > 0 &&
         board_->copy_knot(summary_.newest, summary_.revision, newest_);
}

/// The rate that the board has from a state on, for a solver that did not plan it: the knots after
/// it are the ends of the pieces.
core::RateCurve LawServer::published(const core::LawState& from) noexcept {
  core::RateCurve curve(from.time, {.rate = from.rate, .slope = from.slope});
  Word first = summary_.newest;
  while (first > summary_.first && board_->time_hint(first - 1) > from.time) --first;
  const bool is_plan = summary_.newest - first <= core::RateCurve::kMostPieces;
  for (Word number = first; is_plan && number < summary_.newest; ++number) {
    if (!board_->copy_knot(number, summary_.revision, knot_)) break;
    if (knot_.time > curve.end()) curve.add(knot_.velocity()[0], knot_.time - curve.end());
  }
  return curve;
}

/// Whether the last plan is in force: only what was committed is. If the law is neither that plan
/// nor the one before, it is read from the board again.
void LawServer::judge_sent() noexcept {
  const bool is_committed = planned_at_ && summary_.revision == *planned_at_ + 1;
  const bool follows = is_committed || (planned_at_ && summary_.revision == *planned_at_);
  if (is_committed) {
    rate_.commit();
    line_end_ = sent_.value_or(line_end_);
  }
  is_rate_known_ = follows && newest_.time == line_end_;
  planned_at_ = summary_.revision;
  sent_.reset();
}

void LawServer::poll(const Clock& clock) {
  const Time now = clock.now();
  if (now < next_poll_ && !commanders_.has_news()) return;
  // The table may be full of commanders whose processes have just ended.
  const bool needs_room =
      is_rate_known_ && std::ranges::any_of(commanders_.states(), [&](const auto& state) {
        return state.is_used() && !rate_.knows(state.id);
      });
  // Before a new commander is read, which the next plan makes known.
  if (is_rate_known_) faults_.set(faults_of(commanders_, rate_, max_rate(ring_.header)));
  commanders_.poll(needs_room);
  next_poll_ = now + kPollInterval;
}

LawPlan LawServer::plan(Time now, Time settled) noexcept {
  commanders_.read(now);
  if (!read_newest()) return begin(now, settled);
  judge_sent();
  const auto state = state_at(settled);
  if (!state) return {};  // the law has not begun
  if (!is_rate_known_) take_over(*state);
  const Time begin = rate_.plan_begin(settled);
  const auto curve = rate_.plan(commanders_, begin);
  if (curve) {
    const AppendStatus status =
        ring_.writer.append_plan(curve->pieces(), rate_.slot(), rate_.request(), solved());
    if (status != AppendStatus::accepted) {
      planned_at_.reset();
      return {};
    }
    sent_ = curve->end() + core::kLawLine;
  }
  return {.table = rate_.table(), .must_commit = rate_.has_changes()};
}

/// Continues a law that this process has not planned, or whose plan was not taken.
void LawServer::take_over(const core::LawState& state) noexcept {
  CommanderTable table{};
  (void)board_->copy_commanders(table);
  rate_.take_over(published(state), table);
  line_end_ = newest_.time;
  is_rate_known_ = true;
}

Time LawServer::due() const noexcept { return std::min(next_poll_, commanders_.next_expiry()); }

}  // namespace splinecast::ipc
