#include "apps/record/watch/stream_times.hpp"

#include <chrono>
#include <numeric>
#include <optional>

#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {
namespace {

/// The law is looked up at most this far from now: boards keep no more, and it changes after that.
constexpr Time kFarthest = std::chrono::seconds(64);

/// The law at a host time, which may have passed; nothing if it cannot be read.
std::optional<Time> law_at(ipc::LawFollower& law, Time host) noexcept {
  ipc::LawPoint point;
  if (!has_values(law.ahead(host, point))) return std::nullopt;
  return point.stream;
}

}  // namespace

StreamTimes::StreamTimes(const ipc::RegionHeader& stream, Time wall_offset)
    : is_live_(is_live(ipc::stream_clock(stream))),
      offset_(is_live_ ? wall_offset : Time::zero()) {}

void StreamTimes::find_law(const ipc::RegionHeader& stream, const Trust& trust) {
  if (!law_) law_ = ipc::law_of(stream, trust);
}

Time StreamTimes::stream_time(Time wall, Time otherwise) const noexcept {
  if (!is_live_) return otherwise;
  if (!law_) return wall - offset_;
  return law_at(*law_, wall - offset_).value_or(otherwise);
}

Time StreamTimes::wall_time(Time stream, Time now) const noexcept {
  if (!is_live_ || !law_) return saturated_sum(stream, offset_);
  return saturated_sum(by_law(stream, now - offset_), offset_);
}

/// Searches the host time between one at which the law is before `stream` and one at which it is
/// not.
Time StreamTimes::by_law(Time stream, Time host) const noexcept {
  const std::optional<Time> present = law_at(*law_, host);
  if (!present) return host;
  Time before = host;
  Time after = host;
  Time last = *present;  // the law at the end that moves
  const bool is_past = stream <= *present;
  for (Time step = std::chrono::milliseconds(10); step <= kFarthest; step *= 2) {
    Time& end = is_past ? before : after;
    const std::optional<Time> then = law_at(*law_, is_past ? host - step : host + step);
    if (!then) break;
    (is_past ? after : before) = end;
    end = is_past ? host - step : host + step;
    last = *then;
    if (is_past ? last < stream : last >= stream) break;
  }
  const bool is_between = is_past ? last < stream : last >= stream;
  if (!is_between)
    return saturated_sum(is_past ? before : host, stream - (is_past ? last : *present));
  while (after - before > Time(1)) {
    const Time middle = std::midpoint(before.count(), after.count()) * Time(1);
    const std::optional<Time> then = law_at(*law_, middle);
    if (!then) break;
    (*then < stream ? before : after) = middle;
  }
  return after;
}

}  // namespace splinecast::apps::record
