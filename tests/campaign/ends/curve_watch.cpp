#include "tests/campaign/ends/curve_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace splinecast::campaign::ends {
namespace {

/// Differences of positions and velocities of this part of their terms are rounding.
constexpr double kRounding = 1e-9;
/// Path errors are not measured for a shorter way.
constexpr double kLeastWay = 1e-6;

bool is_same(const Piece& a, const Piece& b) {
  return a.left == b.left && a.order == b.order && a.kind == b.kind &&
         a.coefficients == b.coefficients;
}

}  // namespace

CurveWatch::CurveWatch(const LifePlan& plan, testing::MemoryStream& stream, Tally& tally)
    : plan_(&plan),
      stream_(&stream),
      tally_(&tally),
      ranges_(plan.stream.dimensions.size(), plan.stream.kinds),
      limits_(&plan.stream.window.limits),
      segment_(plan.stream.dimensions.size(), stream.board.reader.smooths()) {
  const Motion& motion = plan.motion;
  const std::size_t dimensions = ranges_.dimensions();
  for (std::size_t d = 0; d < dimensions; ++d) {
    double before = 0;
    for (std::size_t i = 1; i < motion.times.size(); ++i) {
      const double h = to_seconds(motion.times[i] - motion.times[i - 1]);
      double step = motion.value(i, 0, dimensions)[d] - motion.value(i - 1, 0, dimensions)[d];
      // A period is continued with the representative nearest to the last one.
      const Dimension& dimension = plan.stream.dimensions[d];
      if (dimension.kind == DimensionKind::periodic) step = std::remainder(step, dimension.period);
      const double slope = step / h;
      velocity_[d] = std::max(velocity_[d], std::abs(slope));
      const double bend = i > 1 ? std::abs(slope - before) / h : 0;
      acceleration_[d] = std::max(acceleration_[d], 2 * bend);
      before = slope;
    }
  }
}

void CurveWatch::breach(Rule rule, const Piece& piece, const std::string& what) {
  tally_->breach(
      rule, fmt::format("{}, piece {} of kind {} from {} to {} ns, revision {}", what, piece.number,
                        static_cast<int>(piece.kind), (piece.left - plan_->stream.begin).count(),
                        (piece.right - plan_->stream.begin).count(), summary_.revision));
}

const Piece& CurveWatch::at(std::span<const Piece> pieces, Time t) noexcept {
  const auto later = std::ranges::upper_bound(pieces, t, {}, &Piece::left);
  return later == pieces.begin() ? pieces.front() : *(later - 1);
}

const Piece* CurveWatch::find(std::span<const Piece> pieces, ipc::Word number) noexcept {
  const auto found = std::ranges::lower_bound(pieces, number, {}, &Piece::number);
  return found != pieces.end() && found->number == number ? &*found : nullptr;
}

/// Copies the pieces from a number on. Returns false if the board does not have them.
bool CurveWatch::read(ipc::Word from, std::vector<Piece>& out) {
  out.clear();
  const auto& board = stream_->board.reader;
  for (ipc::Word number = from;;) {
    if (segment_.take(board, summary_, number) != ipc::BoardSegment::Taken::whole) return false;
    Piece& piece = out.emplace_back(Piece{.number = segment_.number(),
                                          .left = segment_.left(),
                                          .right = segment_.right(),
                                          .natural_right = segment_.natural_right(),
                                          .order = segment_.order(),
                                          .kind = segment_.kind(),
                                          .is_corner = segment_.left_knot().note.is_corner});
    const auto values = segment_.coefficients();
    std::copy_n(values.begin(), static_cast<std::size_t>(piece.order) * ranges_.dimensions(),
                piece.coefficients.begin());
    if (segment_.is_last(summary_)) return true;
    if (segment_.next() <= number) return false;
    number = segment_.next();
  }
}

void CurveWatch::look(Time rests) {
  const auto& board = stream_->board.reader;
  const ipc::Look look = board.look();
  const ipc::Summary before = summary_;
  if (look.revision == summary_.revision) {
    summary_.settled_until = look.settled_until;
    return;
  }
  if (!board.copy_summary(look, summary_)) {
    return tally_->breach(Rule::samples, fmt::format("no summary of revision {}", look.revision));
  }
  if (summary_.newest == 0) return;
  tally_->count(Event::revisions);
  check_counts(before);
  const Time settled = before.newest > 0 ? std::min(before.settled_until, rests) : Time::min();
  check_excesses(before, settled);
  is_cut_ = summary_.run != before.run && before.newest > 0;
  // Else the curve before is not the path without the end.
  knows_path_ = before.knots == summary_.knots && before.newest > 0;
  check_curve(settled, summary_.finished && !before.finished);
}

/// Reads what had not settled, and checks it.
void CurveWatch::check_curve(Time settled, bool finishes) {
  const auto first_number = std::max<ipc::Word>(summary_.first, 1);
  auto from = std::ranges::upper_bound(pieces_, settled, {}, &Piece::left);
  if (from != pieces_.begin()) --from;
  while (from != pieces_.end() && from->number < first_number) ++from;
  const ipc::Word number = from == pieces_.end() ? first_number : from->number;
  if (!read(number, fresh_)) {
    return tally_->breach(Rule::samples,
                          fmt::format("no piece {}, revision {}", number, summary_.revision));
  }
  old_.assign(from, pieces_.end());
  pieces_.erase(from, pieces_.end());
  const std::size_t first = pieces_.size();
  pieces_.insert(pieces_.end(), fresh_.begin(), fresh_.end());
  check_settled(old_, settled);
  for (std::size_t i = std::max<std::size_t>(first, 1); i < pieces_.size(); ++i) {
    check_joint(pieces_[i - 1], pieces_[i]);
  }
  check_rest();
  for (const Piece& piece : fresh_) {
    const Piece* former = find(old_, piece.number);
    if (former != nullptr && is_same(*former, piece)) continue;
    check_piece(piece, former, finishes);
    show(piece);
  }
  if (finishes) check_end();
}

void CurveWatch::check_counts(const ipc::Summary& before) {
  const auto& s = summary_;
  const bool adds_up = s.consumed == s.knots + s.refused + s.withdrawn + s.controls &&
                       s.refused == std::reduce(s.reasons.begin(), s.reasons.end()) &&
                       s.passed_over <= s.knots && s.consumed >= before.consumed &&
                       s.consumed <= stream_->ring.reader.written();
  if (!adds_up) {
    tally_->breach(
        Rule::accounts,
        fmt::format("consumed {}, accepted {}, passed over {}, refused {}, withdrawn "
                    "{}, controls {}",
                    s.consumed, s.knots, s.passed_over, s.refused, s.withdrawn, s.controls));
  }
  tally_->count(Event::excesses, s.exceeding - before.exceeding);
  tally_->count(Event::refusals, s.refused - before.refused);
  tally_->count(Event::starvations, s.underruns - before.underruns);
  tally_->count(Event::waypoints, s.knots - before.knots);
  tally_->count(Event::waypoints_passed_over,
                s.passed_over - std::min(before.passed_over, s.passed_over));
  tally_->count(Event::withdrawals, s.withdrawn - before.withdrawn);
}

/// What had settled is not compared with limits, except a stop that the curve has begun.
void CurveWatch::check_excesses(const ipc::Summary& before, Time settled) {
  for (ipc::Word i = before.exceeding; i < summary_.exceeding; ++i) {
    const auto excess = stream_->board.reader.excess(summary_, i);
    if (!excess || excess->time >= settled) continue;
    const auto is_in_stop = [&](const Piece& piece) {
      return piece.kind == SegmentKind::stop && piece.left <= excess->time &&
             excess->time <= piece.natural_right;
    };
    if (std::ranges::any_of(fresh_, is_in_stop) || std::ranges::any_of(pieces_, is_in_stop)) {
      continue;
    }
    tally_->breach(Rule::past_not_compared,
                   fmt::format("item {}: {} ns before settled_until, {} of {}", excess->item,
                               (settled - excess->time).count(), excess->value, excess->limit));
  }
}

void CurveWatch::check_settled(std::span<const Piece> old, Time settled) {
  for (std::size_t i = 0; i < old.size() && old[i].left < settled; ++i) {
    const bool is_kept = i < fresh_.size() && is_same(old[i], fresh_[i]) &&
                         fresh_[i].right >= std::min(old[i].right, settled);
    if (is_kept) continue;
    return breach(Rule::settled, old[i],
                  fmt::format("settled until {} ns", (settled - plan_->stream.begin).count()));
  }
}

void CurveWatch::check_joint(const Piece& before, const Piece& after) {
  if (before.right != after.left) {
    return breach(Rule::continuous, after,
                  fmt::format("{} ns apart", (after.left - before.right).count()));
  }
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d)) continue;  // the sign and the length may change
    for (int m = 0; m < (after.is_corner ? 1 : 2); ++m) {
      const double step =
          ranges_.value(after, d, m, 0) - ranges_.value(before, d, m, before.seconds());
      const double scale = ranges_.scale(before, d, m) + ranges_.scale(after, d, m);
      if (std::abs(step) <= kRounding * scale) continue;
      return breach(Rule::continuous, after,
                    fmt::format("derivative {} of dimension {} steps by {}", m, d, step));
    }
  }
}

/// The curve ends at rest, unless it ends as requested, with a condition that does not rest.
void CurveWatch::check_rest() {
  const Piece& piece = last();
  const bool is_requested = summary_.finished && piece.kind == SegmentKind::spline;
  const Rule rule = is_requested && !is_at_rest(plan_->stream.end.kind) ? Rule::requested_end_rests
                                                                        : Rule::ends_at_rest;
  const bool halts = piece.kind != SegmentKind::spline ||
                     (is_requested && plan_->stream.end.kind == ConditionKind::halt);
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    for (int m = 1; m <= (halts ? 2 : 1); ++m) {
      const double value = ranges_.value(piece, d, m, piece.seconds());
      if (std::abs(value) <= kRounding * ranges_.scale(piece, d, m)) continue;
      return breach(rule, piece, fmt::format("derivative {} of dimension {}: {}", m, d, value));
    }
  }
  if (!summary_.finished && piece.kind != SegmentKind::stop && piece.kind != SegmentKind::hold) {
    breach(Rule::ends_at_rest, piece, "no stop");
  }
}

/// Adds a piece to the motion shown.
void CurveWatch::show(const Piece& piece) {
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d)) continue;
    const double a = ranges_.range(piece, d, 2).size();
    if (piece.kind == SegmentKind::spline) {
      velocity_[d] = std::max(velocity_[d], ranges_.range(piece, d, 1).size());
      acceleration_[d] = std::max(acceleration_[d], a);
    } else if (piece.kind == SegmentKind::entry) {
      entered_[d] = std::max(entered_[d], a);
    }
  }
}

void CurveWatch::check_all() {
  if (pieces_.empty()) return;
  const auto first = std::max<ipc::Word>(summary_.first, 1);
  if (!read(first, fresh_)) {
    return tally_->breach(Rule::settled, fmt::format("no piece {} at the end", first));
  }
  for (const Piece& piece : fresh_) {
    const Piece* seen = find(pieces_, piece.number);
    if (seen != nullptr && is_same(*seen, piece) && seen->right == piece.right) continue;
    return breach(Rule::settled, piece, "another piece at the end of the life");
  }
  check_met();
}

/// Whether the waypoint is where the piece is at u; only linear dimensions are compared.
bool CurveWatch::is_at(std::size_t waypoint, const Piece& piece, double u) const {
  const auto position = plan_->motion.value(waypoint, 0, ranges_.dimensions());
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (plan_->stream.dimensions[d].kind != DimensionKind::linear) continue;
    const double off = ranges_.value(piece, d, 0, u) - position[d];
    if (std::abs(off) > kRounding * (ranges_.scale(piece, d, 0) + 1)) return false;
  }
  return true;
}

/// Each accepted waypoint is interpolated, at its time or when the curve has slowed down, or is
/// counted as passed over.
void CurveWatch::check_met() {
  const bool smooths = plan_->stream.window.interpolant.method->smooths();
  const auto& times = plan_->motion.times;
  const bool is_plain = !smooths && !is_replaced_ && summary_.refused == 0;
  if (!is_plain || !summary_.finished || summary_.knots == 0) return;
  const std::size_t known = std::min<std::size_t>(summary_.knots, times.size());
  std::size_t met = 0;
  std::size_t next = 0;
  std::size_t slowed = 0;  // pieces in which the curve slows down, so far
  bool meets_last = false;
  for (const Piece& piece : pieces_) {
    const bool is_late = slowed > 0;
    slowed += piece.kind == SegmentKind::slowed ? 1U : 0U;
    while (!is_late && next < known && times[next] < piece.left) ++next;
    if (next == known || (!is_late && times[next] != piece.left)) continue;
    meets_last = next + 1 == known;
    met += is_at(next++, piece, 0) ? 1U : 0U;
  }
  // A curve may rest at the last waypoint by chance.
  const bool may_end_there = !meets_last && is_at(known - 1, last(), last().seconds());
  const ipc::Word interpolated = summary_.interpolated();
  if (met == interpolated || (may_end_there && met + 1 == interpolated)) return;
  const bool is_elsewhere = summary_.ending() == ipc::EndKind::as_requested &&
                            last().kind == SegmentKind::stop && !may_end_there;
  const Rule rule = is_elsewhere              ? Rule::rest_at_begin
                    : met == interpolated + 1 ? Rule::passed_exactly
                                              : Rule::waypoints_accounted;
  tally_->breach(
      rule, fmt::format("{} waypoints met, {} accepted, {} passed over, end {}, lateness {}", met,
                        summary_.knots, summary_.passed_over, summary_.end_kind,
                        summary_.end_lateness.count()));
}

/// Compares the slowed pieces with the path at the same way along it, relative to the size of the
/// path in linear and periodic dimensions.
void CurveWatch::measure_slowing() {
  const auto first = std::ranges::find(pieces_, SegmentKind::slowed, &Piece::kind);
  if (first == pieces_.end() || old_.empty() || !knows_path_) return;
  const Time begin = first->left;
  const double length = to_seconds(last().right - begin);
  double worst = 0;
  std::array<Range, kMostDimensions> way;
  way.fill({.least = HUGE_VAL, .greatest = -HUGE_VAL});
  for (auto piece = first; piece != pieces_.end(); ++piece) {
    constexpr int kLooks = 8;
    for (int i = 0; i < kLooks; ++i) {
      const double u = piece->seconds() * (i + 0.5) / kLooks;
      const double share = (to_seconds(piece->left - begin) + u) / length;
      const double s = length * (share - share * share * share * (1 - share / 2));
      const Piece& path = at(old_, begin + from_seconds(s));
      const double v = s - to_seconds(path.left - begin);
      double squares = 0;
      for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
        if (ranges_.is_rotation(d)) continue;
        const double x = ranges_.value(path, d, 0, v);
        const double off = ranges_.value(*piece, d, 0, u) - x;
        squares += off * off;
        way[d] = {std::min(way[d].least, x), std::max(way[d].greatest, x)};
      }
      worst = std::max(worst, std::sqrt(squares));
    }
  }
  double squares = 0;
  for (std::size_t d = 0; d < ranges_.dimensions(); ++d) {
    if (ranges_.is_rotation(d)) continue;
    squares += (way[d].greatest - way[d].least) * (way[d].greatest - way[d].least);
  }
  const double size = std::sqrt(squares);
  if (size <= kLeastWay) return;
  tally_->add_path_error(worst / size);
  constexpr double kFarthest = 0.01;
  if (worst <= kFarthest * size) return;
  breach(Rule::near_path, *first, fmt::format("{} away, on a way of size {}", worst, size));
}

}  // namespace splinecast::campaign::ends
