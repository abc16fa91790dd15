#include "ipc/owned/old_motion.hpp"

#include <algorithm>
#include <exception>

#include "ipc/board/reader.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {
namespace {

/// Tries to read a board whose solver may overtake an observer.
constexpr int kSummaryTries = 16;

/// The earliest host time at which the law of a stream can reach a stream time; `stream` if the
/// stream follows none.
Time host_time_of(Time stream, const RegionHeader& header, const Trust& trust) noexcept {
  if (header.law_id == 0) return stream;
  try {
    LawFollower law(header, trust);
    const MonotonicClock host;
    LawPoint point;
    if (!has_values(law.at(host.now(), point))) return Time::min();
    const Time now = point.stream;
    const double left = to_seconds(std::max(stream - now, Time::zero())) / law.max_rate();
    return saturated_sum(host.now(), from_seconds(left));
  } catch (const std::exception&) {
    return Time::min();
  }
}

}  // namespace

std::optional<Summary> take_last_segment(const KnotBoardReader& board,
                                         BoardSegment& last) noexcept {
  Summary summary;
  for (int attempt = 0; attempt < kSummaryTries; ++attempt) {
    const Look look = board.look();
    if (look.revision == 0) return Summary{};
    if (!board.copy_summary(look, summary)) continue;
    if (summary.newest == 0 || last.take_last(board, summary)) return summary;
  }
  return std::nullopt;
}

Time end_of_motion(const RegionHeader& header, const KnotBoardReader& board,
                   const Trust& trust) noexcept {
  if (stream_clock(header) == StreamClock::recorded || header.time_namespace != time_namespace() ||
      board.retired()) {
    return Time::min();
  }
  BoardSegment last(board.dimensions(), board.smooths());
  const auto summary = take_last_segment(board, last);
  if (!summary || summary->newest == 0) return Time::min();
  return host_time_of(last.right(), header, trust);
}

Time end_of_motion(const std::string& stream, const Trust& trust) {
  try {
    const auto [region, header, layout] = open_board(stream, false, trust);
    return end_of_motion(header, KnotBoardReader(region.bytes(), layout), trust);
  } catch (const StreamError&) {
    return Time::min();
  }
}

void require_near_end(const std::string& stream, Time end, Time now) {
  if (end <= now || end - now <= kLongestOldMotion) return;
  throw BadRegion(
      "stream '" + stream + "' was recreated, but its old motion ends at " +
      std::to_string(end.count()) +
      " ns, more than an hour from now: stop its writers, then remove it with 'splinecast rm " +
      stream + "'");
}

Time end_of_old_motion(const std::string& stream, std::uint64_t stream_id, const Trust& trust) {
  try {
    const auto peeked = peek_header(stream, RegionKind::spline, trust);
    if (!peeked || peeked->stream_id == stream_id) return Time::min();
    const auto [region, header, layout] = open_board(stream, false, trust);
    if (header.stream_id == stream_id) return Time::min();
    return end_of_motion(header, KnotBoardReader(region.bytes(), layout), trust);
  } catch (const StreamError&) {
    return Time::min();  // removed meanwhile, or not usable by this user
  }
}

}  // namespace splinecast::ipc
