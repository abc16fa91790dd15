#include "ipc/owned/old_end.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <exception>
#include <new>
#include <span>
#include <utility>

#include "core/polynomial/segment.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/old_motion.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {
namespace {

/// A distance that comes from rounding in the evaluation of the old curve.
constexpr double kRounding = 1e-9;

/// A number with nine digits.
std::string short_text(double value) {
  std::array<char, 32> text{};
  return {text.begin(),
          std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 9).ptr};
}

std::string list_of(std::span<const double> values) {
  std::string text = "(";
  for (const double value : values) {
    if (text.size() > 1) text += ", ";
    text += short_text(value);
  }
  return text + ')';
}

}  // namespace

CurveEnd end_of_curve(const RegionHeader& header, const KnotBoardReader& board) {
  const DimensionKinds kinds = dimension_kinds(header);
  const auto checked = [&](std::span<const double> x) {
    const bool is_usable = is_finite(x) && kinds.takes(x);
    return is_usable ? std::vector<double>(x.begin(), x.end()) : std::vector<double>();
  };
  BoardSegment last(board.dimensions(), board.smooths());
  const auto summary = take_last_segment(board, last);
  if (!summary) return {};
  if (summary->newest == 0) {
    std::vector<double> position(board.dimensions());
    if (!board.copy_old_end(position)) position.clear();
    return {.position = checked(position), .is_final = summary->finished};
  }
  State state(board.dimensions());
  core::evaluate(last.order(), last.coefficients(), to_seconds(last.right() - last.left()),
                 state.ref());
  kinds.normalise(state.ref());
  return {checked(state.position()), last.right(), summary->finished, true};
}

bool may_follow(const RegionHeader& ring, const RegionHeader& board) {
  return is_live(stream_clock(ring)) && is_live(stream_clock(board)) && ring.is_law == 0 &&
         board.is_law == 0 && dimensions_of(ring) == dimensions_of(board);
}

OldEnd::OldEnd(std::string stream, BoardView board, const RegionHeader& ring, double tolerance)
    : stream_(std::move(stream)),
      board_(std::move(board)),
      kinds_(dimension_kinds(board_.header)),
      limits_(window_options(board_.header).limits),
      tolerance_(tolerance),
      way_(kinds_, board_.header.dimensions),
      has_same_clock_(board_.header.clock == ring.clock && board_.header.law_id == ring.law_id) {}

std::optional<OldEnd> OldEnd::find(const std::string& stream, const RegionHeader& ring,
                                   double tolerance, const Trust& trust) {
  if (!is_live(stream_clock(ring))) return std::nullopt;
  try {
    if (!peek_header(stream, RegionKind::spline, trust)) return std::nullopt;
    auto opened = open_board(stream, false, trust);
    if (!may_follow(ring, opened.header)) return std::nullopt;
    OldEnd end(stream, BoardView(std::move(opened)), ring, tolerance);
    auto found = end_of_curve(end.board_.header, end.board_.reader);
    if (end.board_.header.stream_id == ring.stream_id) {
      if (found.position.empty() || found.is_own) return std::nullopt;
      found.is_final = true;
    }
    end.take(std::move(found));
    return end;
  } catch (const StreamError&) {
    return std::nullopt;  // no board, or one that this user cannot read
  }
}

void OldEnd::take(CurveEnd end) {
  position_ = std::move(end.position);
  rest_ = has_same_clock_ ? end.rest : Time::min();
  is_final_ = end.is_final;
}

/// Whether no solver will change the old curve any more.
bool OldEnd::is_final() const noexcept {
  if (board_.reader.retired()) return true;
  try {
    return !owner_lives(stream_, RegionKind::spline);
  } catch (const std::exception&) {
    return false;
  }
}

OldEnd::Known OldEnd::look() noexcept {
  if (!is_final_) {
    try {
      const bool is_final_now = is_final();  // before the end is read
      take(end_of_curve(board_.header, board_.reader));
      is_final_ = is_final_ || is_final_now;
    } catch (const std::bad_alloc&) {
      return Known::not_yet;
    }
  }
  if (!is_final_) return Known::not_yet;
  return position_.empty() ? Known::no : Known::yes;
}

void OldEnd::move_to(std::span<const double> position) {
  position_.assign(position.begin(), position.end());
  rest_ = Time::min();
  is_final_ = true;
}

bool OldEnd::is_near(std::span<const double> position) noexcept {
  if (!kinds_.takes(position)) return false;
  way_.measure(position_, position);
  return std::ranges::all_of(way_.distances(), [this](double way) { return way <= tolerance_; });
}

/// Whether dimension d of the way that was measured is short enough.
bool OldEnd::is_reached(std::size_t d, Time available, const MotionLimits& limits) const noexcept {
  const auto seconds = way_.seconds(d, limits);
  return seconds ? *seconds <= to_seconds(available) : way_.distances()[d] <= tolerance_;
}

OldEnd::Way OldEnd::way_to(std::span<const double> position, Time available,
                           const MotionLimits& limits) noexcept {
  if (!kinds_.takes(position)) return Way::there;  // the solver refuses it
  way_.measure(position_, position);
  Way way = Way::there;
  for (std::size_t d = 0; d < position.size(); ++d) {
    if (!is_reached(d, available, limits)) return Way::elsewhere;
    if (way_.seconds(d, limits) && way_.distances()[d] > kRounding) way = Way::entry;
  }
  return way;
}

std::string OldEnd::why_elsewhere(std::span<const double> position, Time available,
                                  const MotionLimits& limits) {
  if (!is_final_) {
    return "the solver of the earlier stream '" + stream_ +
           "' may still move its end: wait for a solver of this stream first";
  }
  if (position_.empty()) return {};
  way_.measure(position_, position);
  std::string text = "the earlier stream '" + stream_ + "' came to rest at " + list_of(position_) +
                     ", this one would begin at " + list_of(position);
  const std::vector<std::string> names = dimension_names(board_.header);
  for (std::size_t d = 0; d < position.size(); ++d) {
    if (is_reached(d, available, limits)) continue;
    const auto seconds = way_.seconds(d, limits);
    text += ": dimension " + std::to_string(d) + (names[d].empty() ? "" : " (" + names[d] + ')') +
            " is " + short_text(way_.distances()[d]) + " away, ";
    text += seconds ? "which takes " + short_text(*seconds) + " s within the limits, not " +
                          short_text(to_seconds(available)) + " s"
                    : "more than the tolerance " + short_text(tolerance_);
    break;
  }
  return text +
         ". Start from the old end or from a measured state near it, or say that the machine was "
         "moved";
}

}  // namespace splinecast::ipc
