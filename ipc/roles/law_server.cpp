#include "ipc/roles/law_server.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>

#include "ipc/law/follower.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "splinecast/method.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {
namespace {

constexpr Time kLookEvery = std::chrono::milliseconds(20);

/// A law begins this long after its ring has been made: its solver must publish it before.
constexpr Time kNotice = std::chrono::milliseconds(20);

/// Length of the straight line after the last ramp: about 36 years.
constexpr Time kLine{std::int64_t{1} << 60};

/// Accelerations beyond any ramp. With this limit an entry is not compared with the motion that the
/// law has shown, and ends at the first waypoint after it.
constexpr double kBeyondAnyRamp = 1e12;

constexpr std::array<double, 1> kZero{0};

/// Waypoints of a law's curve, in arrays of their own.
class LawWaypoints {
 public:
  LawWaypoints() = default;
  LawWaypoints(const LawWaypoints&) = delete;
  LawWaypoints& operator=(const LawWaypoints&) = delete;
  ~LawWaypoints() = default;

  /// Adds a state with slope 0.
  void add(const core::LawState& state) noexcept {
    values_[count_] = {state.position, state.rate};
    const auto both = std::span<const double>(values_[count_]);
    waypoints_[count_] = {.time = state.time,
                          .position = both.first(1),
                          .velocity = both.subspan(1, 1),
                          .acceleration = kZero};
    ++count_;
  }
  /// Adds the end of the straight line that begins in such a state.
  void add_line(const core::LawState& from) noexcept {
    add(core::end_of_piece(from, from.rate, kLine));
  }
  [[nodiscard]] std::span<const Waypoint> all() const noexcept {
    return std::span(waypoints_).first(count_);
  }

 private:
  static constexpr std::size_t kMost = core::RateCurve::kMostPieces + 1;
  std::array<std::array<double, 2>, kMost> values_{};  ///< position and rate
  std::array<Waypoint, kMost> waypoints_{};
  std::size_t count_ = 0;
};

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

bool LawServer::is_wanted(const std::string& law) {
  return !commander_names(law).empty() && !is_owned(law, RegionKind::waypoints);
}

SolverOptions LawServer::solver_options(const SolverOptions& options) {
  return {.method = find_method("quintic"),
          .limits = MotionLimits{.acceleration = {kBeyondAnyRamp}},
          .freeze_ahead = options.freeze_ahead,
          .history = options.history,
          .min_entry = Time(1),
          .wake = options.wake,
          .access = options.access,
          .trust = options.trust};
}

LawServer::LawServer(const std::string& law, const SolverOptions& options)
    : lock_(law, RegionKind::waypoints),
      ring_(own_ring(law, ring_options(options), lock_,
                     [&](RegionHeader& header) {
                       describe_law(header);
                       header.largest_rate = options.largest_rate.value_or(1.0);
                     })),
      commanders_(law, options.trust),
      rate_(ring_.header.largest_rate) {
  lock_.keep_file();
  commanders_.look_around();
}

void LawServer::attach(const KnotBoardReader& board, const RegionHeader& header) {
  board_ = &board;
  sampler_.emplace(board, StreamClock::monotonic);
  freeze_ahead_ = Time(header.freeze_ahead);
}

WaypointRingWriter::Solved LawServer::solved() const noexcept {
  return {.consumed = board_->consumed(), .settled_until = board_->look().settled_until};
}

/// Begins the law at the requested rate. One replacement, so that a curve with one of its two
/// waypoints is never published, also if this process dies or is delayed.
void LawServer::begin(const Clock& clock) {
  commanders_.read(clock.now());
  const double rate = least_rate(commanders_.states(), ring_.header.largest_rate);
  const Time start = clock.now() + std::max(kNotice, 2 * freeze_ahead_);
  const core::LawState first{.time = start,
                             .position = to_seconds(start - Time(ring_.header.law_origin)),
                             .rate = rate,
                             .slope = 0};
  LawWaypoints waypoints;
  waypoints.add(first);
  waypoints.add_line(first);
  (void)ring_.writer.replace_from(start - Time(1), waypoints.all(), solved());
}

std::optional<core::LawState> LawServer::state_at(Time time) noexcept {
  return law_state_at(*sampler_, time, ring_.header.largest_rate, state_);
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

/// Whether the plan that was sent last is in force: only what was committed is. If the law is
/// neither that plan nor the one before, its rate is read from the board again.
void LawServer::judge_sent() noexcept {
  if (sent_ && newest_.time == *sent_) {
    rate_.commit();
    line_end_ = *sent_;
  }
  is_rate_known_ = newest_.time == line_end_;
  sent_.reset();
}

void LawServer::send(const core::RateCurve& curve, const core::LawState& from) {
  LawWaypoints waypoints;
  core::LawState end = from;
  for (const core::RatePiece& piece : curve.pieces()) {
    end = core::end_of_piece(end, piece.end_rate, piece.length);
    waypoints.add(end);
  }
  waypoints.add_line(end);
  const AppendStatus status = ring_.writer.replace_from(from.time, waypoints.all(), solved());
  if (status == AppendStatus::accepted) sent_ = waypoints.all().back().time;
}

void LawServer::step(const Clock& clock) {
  if (clock.now() >= next_look_) {
    commanders_.look_around();
    next_look_ = clock.now() + kLookEvery;
  }
  if (board_ == nullptr || board_->consumed() != ring_.writer.written()) return;
  if (!read_newest()) return begin(clock);
  if (is_rate_known_) judge_sent();
  const Time now = clock.now();  // after all system calls of unknown length
  // The solver's step follows at once; a little later than settled, so that it is not too late.
  const Time margin = std::max<Time>(freeze_ahead_ / 16, std::chrono::microseconds(200));
  const Time from = std::max(board_->look().settled_until, now + freeze_ahead_) + margin;
  commanders_.read(now);
  if (!is_rate_known_) {
    const auto state = state_at(from);
    if (!state) return;  // the law has not begun
    rate_.begin(published(*state), commanders_, from);
    line_end_ = newest_.time;
    is_rate_known_ = true;
  }
  const Time begin = rate_.plan_begin(from);
  const auto state = state_at(begin);
  if (!state) return;
  if (const auto curve = rate_.plan(commanders_, begin)) send(*curve, *state);
}

Time LawServer::due() const noexcept { return std::min(next_look_, commanders_.next_expiry()); }

}  // namespace splinecast::ipc
