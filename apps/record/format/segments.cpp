#include <fmt/format.h>

#include <array>

#include "apps/record/format/messages.hpp"

/// The messages of segments, restarts and summaries.
namespace splinecast::apps::record {
namespace {

constexpr std::uint8_t kHasWaypoint = 1;
constexpr std::uint8_t kEndsAtWaypoint = 2;
constexpr std::uint8_t kHasItem = 4;
constexpr std::uint8_t kHasStep = 8;
constexpr std::uint8_t kIsCorner = 16;
constexpr std::uint8_t kIsStopped = 32;
constexpr std::uint8_t kHasKnots = 1;
constexpr std::uint8_t kIsLaterRun = 2;
constexpr std::uint8_t kHasAccelerations = 1;
constexpr std::uint8_t kHasResiduals = 2;

void put(ByteWriter& out, const ipc::SegmentCopy& segment) {
  const ipc::SegmentOrigin& origin = segment.origin;
  const auto flags = static_cast<std::uint8_t>(
      (segment.has_waypoint ? kHasWaypoint : 0) | (origin.ends_at_waypoint ? kEndsAtWaypoint : 0) |
      (origin.item ? kHasItem : 0) | (segment.acceleration_step.empty() ? 0 : kHasStep) |
      (segment.is_corner ? kIsCorner : 0) | (origin.stopped_by > 0 ? kIsStopped : 0));
  out.put(segment.number)
      .put(segment.next)
      .put(segment.left)
      .put(segment.right)
      .put(segment.natural_right)
      .put(static_cast<std::uint8_t>(segment.order))
      .put(static_cast<std::uint8_t>(segment.kind))
      .put(flags)
      .put(std::uint8_t{0})
      .put(segment.newer_knots)
      .put(origin.right_newer_knots)
      .put(origin.item.value_or(0))
      .put(origin.stopped_by > 0 ? origin.stopped_by : origin.known)
      .put(segment.coefficients)
      .put(segment.waypoint)
      .put(segment.acceleration_step);
}

void require_order(int order) {
  if (order < 1 || order > kMaxOrder) throw BadMessage(fmt::format("it has order {}", order));
}

ipc::SegmentCopy take_segment(ByteReader& in, std::size_t dimensions) {
  ipc::SegmentCopy segment{.number = in.take<ipc::Word>(), .next = in.take<ipc::Word>()};
  segment.left = in.take_time();
  segment.right = in.take_time();
  segment.natural_right = in.take_time();
  segment.order = in.take<std::uint8_t>();
  require_order(segment.order);
  const auto kind = in.take<std::uint8_t>();
  if (kind > static_cast<std::uint8_t>(SegmentKind::slowed)) {
    throw BadMessage(fmt::format("it has segment kind {}", kind));
  }
  segment.kind = static_cast<SegmentKind>(kind);
  const auto flags = in.take<std::uint8_t>();
  (void)in.take<std::uint8_t>();
  segment.newer_knots = in.take<std::uint32_t>();
  segment.origin.right_newer_knots = in.take<std::uint32_t>();
  const auto item = in.take<ipc::Word>();
  if ((flags & kHasItem) != 0) segment.origin.item = item;
  const bool is_stopped = (flags & kIsStopped) != 0;
  (is_stopped ? segment.origin.stopped_by : segment.origin.known) = in.take<ipc::Word>();
  segment.origin.ends_at_waypoint = (flags & kEndsAtWaypoint) != 0;
  segment.has_waypoint = (flags & kHasWaypoint) != 0;
  segment.is_corner = (flags & kIsCorner) != 0;
  const bool is_in_range = is_time_in_range(segment.left / 2) &&
                           is_time_in_range(segment.right / 2) &&
                           is_time_in_range(segment.natural_right / 2) &&
                           segment.left <= segment.right && segment.right <= segment.natural_right;
  if (!is_in_range) throw BadMessage("its times are not in order");
  std::int64_t length = 0;
  if (__builtin_sub_overflow(segment.natural_right.count(), segment.left.count(), &length)) {
    throw BadMessage("it is longer than 2^63 ns");
  }
  segment.coefficients = in.take_doubles(static_cast<std::size_t>(segment.order) * dimensions);
  segment.waypoint = in.take_doubles(segment.has_waypoint ? dimensions : 0);
  segment.acceleration_step = in.take_doubles((flags & kHasStep) != 0 ? dimensions : 0);
  return segment;
}

void put(ByteWriter& out, const ipc::RunRestart& restart) {
  const ipc::RestartKnot& any = restart.knots.front();
  const auto flags = static_cast<std::uint8_t>((any.acceleration.empty() ? 0 : kHasAccelerations) |
                                               (any.residual.empty() ? 0 : kHasResiduals));
  out.put(restart.run_item)
      .put(std::uint64_t{restart.first})
      .put(static_cast<std::uint32_t>(restart.knots.size()))
      .put(flags);
  for (const ipc::RestartKnot& knot : restart.knots) {
    out.put(knot.time)
        .put(knot.prefix.gamma)
        .put(knot.prefix.smoothing.pivot)
        .put(knot.prefix.smoothing.lower1)
        .put(knot.prefix.smoothing.lower2)
        .put(knot.waypoint)
        .put(knot.g)
        .put(knot.position)
        .put(knot.velocity)
        .put(knot.acceleration)
        .put(knot.residual);
  }
}

ipc::RestartKnot take_knot(ByteReader& in, std::size_t dimensions, std::uint8_t flags) {
  ipc::RestartKnot knot{.time = in.take_time()};
  knot.prefix.gamma = in.take<double>();
  knot.prefix.smoothing.pivot = in.take<double>();
  knot.prefix.smoothing.lower1 = in.take<double>();
  knot.prefix.smoothing.lower2 = in.take<double>();
  knot.waypoint = in.take_doubles(dimensions);
  knot.g = in.take_doubles(dimensions);
  knot.position = in.take_doubles(dimensions);
  knot.velocity = in.take_doubles(dimensions);
  knot.acceleration = in.take_doubles((flags & kHasAccelerations) != 0 ? dimensions : 0);
  knot.residual = in.take_doubles((flags & kHasResiduals) != 0 ? dimensions : 0);
  return knot;
}

/// The members of a summary, in the order of the message.
constexpr std::array kSummaryWords{
    &ipc::Summary::revision,     &ipc::Summary::first,     &ipc::Summary::newest,
    &ipc::Summary::run_item,     &ipc::Summary::run_knots, &ipc::Summary::run_frozen,
    &ipc::Summary::consumed,     &ipc::Summary::knots,     &ipc::Summary::passed_over,
    &ipc::Summary::withdrawn,    &ipc::Summary::controls,  &ipc::Summary::refused,
    &ipc::Summary::exceeding,    &ipc::Summary::underruns, &ipc::Summary::deadline_misses,
    &ipc::Summary::late_commits,
};

}  // namespace

std::string_view to_string(SegmentKind kind) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"spline", "entry", "stop", "hold", "slowed"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Bytes encode(const ipc::SegmentCopy& segment) {
  constexpr std::size_t kFixed = 72;
  Bytes bytes;
  bytes.reserve(kFixed + (segment.coefficients.size() + segment.waypoint.size() +
                          segment.acceleration_step.size()) *
                             sizeof(double));
  bytes.push_back(static_cast<std::byte>(RecordKind::segment));
  ByteWriter out(bytes);
  put(out, segment);
  return bytes;
}

ipc::SegmentCopy decode_segment(std::span<const std::byte> bytes, std::size_t dimensions) {
  ByteReader in(bytes);
  ipc::SegmentCopy segment = take_segment(in, dimensions);
  in.require_end();
  return segment;
}

std::pair<Time, Time> times_of_segment(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  (void)in.take<ipc::Word>();
  (void)in.take<ipc::Word>();
  const Time left = in.take_time();
  return {left, in.take_time()};
}

Bytes encode(const Restart& restart) {
  Bytes bytes;
  bytes.push_back(static_cast<std::byte>(RecordKind::restart));
  ByteWriter out(bytes);
  const bool is_later = restart.knots && restart.knots->is_later_run;
  out.put(static_cast<std::uint8_t>((restart.knots ? kHasKnots : 0) | (is_later ? kIsLaterRun : 0)))
      .put(restart.first_item);
  put(out, restart.before);
  if (restart.knots) put(out, *restart.knots);
  return bytes;
}

Restart decode_restart(std::span<const std::byte> bytes, std::size_t dimensions) {
  ByteReader in(bytes);
  const auto flags = in.take<std::uint8_t>();
  Restart restart{.first_item = in.take<ipc::Word>()};
  restart.before = take_segment(in, dimensions);
  if ((flags & kHasKnots) != 0) {
    ipc::RunRestart& knots = restart.knots.emplace();
    knots.is_later_run = (flags & kIsLaterRun) != 0;
    knots.run_item = in.take<ipc::Word>();
    knots.first = in.take<std::uint64_t>();
    const auto count = in.take<std::uint32_t>();
    const auto kinds = in.take<std::uint8_t>();
    for (std::uint32_t k = 0; k < count; ++k) {  // a message that is too short ends it
      knots.knots.push_back(take_knot(in, dimensions, kinds));
    }
  }
  in.require_end();
  return restart;
}

Bytes encode(const Published& published) {
  const ipc::Summary& summary = published.summary;
  Bytes bytes;
  bytes.push_back(static_cast<std::byte>(RecordKind::summary));
  ByteWriter out(bytes);
  out.put(static_cast<std::uint8_t>(summary.finished ? 1 : 0))
      .put(summary.settled_until)
      .put(summary.newest_time);
  for (const auto member : kSummaryWords) out.put(summary.*member);
  out.put(summary.end_kind).put(summary.end_item).put(summary.end_lateness);
  if (!published.open) return bytes;
  out.put(published.open->until);
  put(out, published.open->segment);
  return bytes;
}

Published decode_published(std::span<const std::byte> bytes, std::size_t dimensions) {
  ByteReader in(bytes);
  Published published;
  ipc::Summary& summary = published.summary;
  summary.finished = in.take<std::uint8_t>() != 0;
  summary.settled_until = in.take_time();
  summary.newest_time = in.take_time();
  for (const auto member : kSummaryWords) summary.*member = in.take<ipc::Word>();
  if (in.rest().empty()) return published;  // of an earlier version
  summary.end_kind = in.take<ipc::Word>();
  summary.end_item = in.take<ipc::Word>();
  summary.end_lateness = in.take_time();
  if (in.rest().empty()) return published;
  published.open.emplace().until = in.take_time();
  published.open->segment = take_segment(in, dimensions);
  in.require_end();
  return published;
}

}  // namespace splinecast::apps::record
