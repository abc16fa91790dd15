#include "ipc/law/follower.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// The board of a law.
CheckedRegion<BoardLayout> open_law(const std::string& law, const Trust& trust) {
  auto opened = open_board(law, false, trust);
  if (opened.header.is_law == 0) throw BadRegion("stream '" + law + "' is not a time law");
  require_same_clock(opened.header, law);
  return opened;
}

/// The board of the law that a stream's header names. Before a law has a board, it has a ring.
CheckedRegion<BoardLayout> open_law(const RegionHeader& stream, const Trust& trust) {
  const std::string law = text_of(stream.law);
  try {
    auto opened = open_law(law, trust);
    if (opened.header.stream_id == stream.law_id) return opened;
  } catch (const NoSuchStream&) {
    const auto ring = peek_header(law, RegionKind::waypoints, trust);
    if (ring && ring->stream_id == stream.law_id) throw;
    throw LawLost("law lost: the time law '" + law + "' has been removed");
  }
  throw LawLost("law lost: another stream has the name of the time law '" + law + "' now");
}

}  // namespace

RegionHeader header_of_law(const std::string& law, const Trust& trust) {
  const auto header = peek_header(law, RegionKind::spline, trust);
  if (header && header->is_law != 0) return *header;
  throw NoSuchStream("there is no time law '" + law + "' with a solver");
}

LawFollower::LawFollower(const RegionHeader& stream, const Trust& trust)
    : LawFollower(BoardView(open_law(stream, trust)), text_of(stream.law)) {}

LawFollower::LawFollower(const std::string& law, const Trust& trust)
    : LawFollower(BoardView(open_law(law, trust)), law) {}

LawFollower::LawFollower(BoardView law, std::string name)
    : name_(std::move(name)),
      board_(std::move(law)),
      sampler_(board_.reader, StreamClock::monotonic),
      state_(1) {
  sampler_.follow_retired();
}

std::unique_ptr<LawFollower> law_of(const RegionHeader& stream, const Trust& trust) {
  if (stream.law_id == 0) return nullptr;
  try {
    return std::make_unique<LawFollower>(stream, trust);
  } catch (const NoSuchStream&) {  // or LawLost
    return nullptr;
  }
}

SampleStatus LawFollower::convert(SampleStatus status, LawPoint& out) const noexcept {
  if (!has_values(status)) return status;
  out = point_of(board_.header, state_.position()[0],
                 {.rate = state_.velocity()[0],
                  .slope = state_.acceleration()[0],
                  .curvature = state_.jerk()[0]});
  return status;
}

std::optional<core::LawState> law_state_at(Sampler& sampler, Time host, double max_rate,
                                           State& scratch) noexcept {
  if (!has_values(sampler.preview(host, scratch.ref()))) return std::nullopt;
  // The straight line after a ramp is curved by rounding.
  constexpr double kLeastSlope = 1e-12;
  const double slope = scratch.acceleration()[0];
  return core::LawState{.time = host,
                        .position = scratch.position()[0],
                        .rate = std::clamp(scratch.velocity()[0], 0.0, max_rate),
                        .slope = std::abs(slope) < kLeastSlope ? 0 : slope};
}

std::optional<core::LawState> LawFollower::state_at(Time host) noexcept {
  return law_state_at(sampler_, host, max_rate(), state_);
}

SampleStatus LawFollower::sample(Time host, bool is_executed, LawPoint& out) noexcept {
  const StateRef state = state_.ref();
  return convert(is_executed ? sampler_.sample(host, state) : sampler_.preview(host, state), out);
}

SampleStatus LawFollower::at(Time host, LawPoint& out) noexcept {
  const SampleStatus status = look_up(host, true, out);
  if (!has_values(status)) return status;
  last_ = out;
  last_host_ = host;
  return status;
}

Time LawFollower::final_until(Time host) noexcept {
  LawPoint point;
  SampleStatus status = ahead(host, point);
  // Never changes before settled_until: the last time that has settled.
  const Time settled = settled_until() - Time(1);
  if (!has_values(status) || settled > host) status = ahead(settled, point);
  return has_values(status) ? saturated_sum(point.stream, Time(1)) : Time::min();
}

Time LawClock::now() const noexcept {
  host_now_ = host_->now();
  LawPoint point;
  if (has_values(law_->at(host_now_, point))) return point.stream;
  const double seconds = to_seconds(std::max(host_now_ - law_->last_host(), Time::zero()));
  return law_->last().stream + from_seconds(law_->max_rate() * seconds);
}

Time LawClock::latest(Time now, Time ahead) const noexcept {
  const Time end = host_now_ + ahead;
  const Time settled = std::clamp(law_->settled_until(), host_now_, end);
  LawPoint then;
  const bool is_known = has_values(law_->ahead(settled, then));
  const Time from = is_known ? std::max(then.stream, now) : now;
  const Time rest = end - (is_known ? settled : host_now_);
  // One nanosecond more, because `stream` is rounded down.
  return from + from_seconds(law_->max_rate() * to_seconds(rest)) + Time(1);
}

std::optional<Time> LawClock::held() const noexcept {
  const Time settled = law_->settled_until();
  LawPoint then;
  const bool is_known = is_held() && host_now_ == law_->last_host() && host_now_ < settled &&
                        has_values(law_->ahead(settled - Time(1), then));
  if (!is_known) return std::nullopt;
  const LawPoint& now = law_->last();
  const bool is_same = then.stream == now.stream && then.fraction == now.fraction;
  return is_same ? std::optional(now.stream) : std::nullopt;
}

}  // namespace splinecast::ipc
