#include "splinecast/ipc/stream_solver.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace splinecast::ipc {
namespace {

/// Most items of one revision: bounds how long a step takes.
constexpr std::size_t kMaxBatch = 256;

/// Segments that a revision may change besides one per item: those of the open knots, the one
/// before them, and the stop tail.
constexpr std::size_t changed_besides(std::size_t settle) noexcept { return settle + 4; }

constexpr core::Time kNothingChanged = core::Time::max();

/// What an interval is refused for.
Refusal to_refusal(AppendStatus status) noexcept {
  switch (status) {
    case AppendStatus::duplicate:
      return Refusal::duplicate;
    case AppendStatus::out_of_order:
      return Refusal::out_of_order;
    case AppendStatus::too_close:
      return Refusal::too_close;
    default:
      return Refusal::too_far_apart;
  }
}

core::Waypoint waypoint_of(const RingItem& item) noexcept {
  const std::size_t dimensions = item.values.size() / 3;
  const auto values = std::span<const double>(item.values);
  core::Waypoint waypoint{.time = item.time, .position = values.first(dimensions)};
  if (item.has_velocity) waypoint.velocity = values.subspan(dimensions, dimensions);
  if (item.has_acceleration) waypoint.acceleration = values.last(dimensions);
  return waypoint;
}

core::WaypointValues values_of(RingItem& item) noexcept {
  const std::size_t dimensions = item.values.size() / 3;
  const auto values = std::span(item.values);
  core::WaypointValues all{.position = values.first(dimensions)};
  if (item.has_velocity) all.velocity = values.subspan(dimensions, dimensions);
  if (item.has_acceleration) all.acceleration = values.last(dimensions);
  return all;
}

}  // namespace

std::size_t StreamSolver::min_capacity(std::size_t settle) noexcept {
  return 2 * changed_besides(settle);
}

StreamSolver::StreamSolver(const WaypointRingReader& ring, SegmentBoardWriter& board,
                           const SegmentBoardReader& published, const core::WindowOptions& window,
                           const IngestLimits& limits, core::DimensionKinds kinds)
    : ring_(&ring),
      board_(&board),
      limits_(limits),
      kinds_(std::move(kinds)),
      window_(ring.dimensions(), window),
      max_batch_(std::min(kMaxBatch, board.capacity() - changed_besides(window.settle))),
      item_(ring.dimensions()),
      segment_(ring.dimensions()) {
  if (board.capacity() < min_capacity(window.settle)) {
    throw std::invalid_argument("a board of " + std::to_string(board.capacity()) +
                                " segments is too small for settle lag " +
                                std::to_string(window.settle));
  }
  end_.value.reserve(ring.dimensions());
  restore(published);
}

void StreamSolver::restore(const SegmentBoardReader& published) {
  const Word r = published.revision();
  if (r == 0 || !published.copy_head(r, head_)) return;
  board_->store_tail(head_.consumed);  // its last writer may have died between commit and tail
  if (head_.finished || head_.knots == 0) return;
  const std::size_t knots = head_.knots;
  const std::size_t count = std::min(knots, window_.knots_to_restore());
  const std::size_t size = SegmentBoardReader::kKnotValues * ring_->dimensions();
  std::vector<double> values(size * count);
  std::vector<core::Knot> restored;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = knots - count + k;
    restored.push_back(published.knot(i + 1, r, std::span(values).subspan(size * k, size)));
  }
  window_.restore(knots - count, restored);
  settled_written_ = window_.settled_segments();
}

StepResult StreamSolver::step(const Clock& clock) noexcept {
  const Word available = ring_->head() - head_.consumed;
  if (available == 0) return {};
  const Word batch = std::min<Word>({available, max_batch_, ring_->capacity()});
  head_.changed_from = kNothingChanged;
  for (Word k = 0; k < batch; ++k) {
    const Word number = head_.consumed++;
    ring_->copy(number, item_);
    take(item_, number);
  }
  publish(clock);
  return {.consumed = batch, .published = true};
}

void StreamSolver::take(RingItem& item, Word number) noexcept {
  if (head_.finished) return refuse(number, Refusal::after_finish);
  switch (item.kind) {
    case ItemKind::waypoint:
      return take_waypoint(item, number);
    case ItemKind::finish:
      return take_finish(item, number);
    case ItemKind::replace:
    case ItemKind::start_state:
      break;
  }
  refuse(number, Refusal::unknown_kind);
}

/// The producer has checked all of this; but what another process wrote is never trusted.
void StreamSolver::take_waypoint(RingItem& item, Word number) noexcept {
  const core::Waypoint waypoint = waypoint_of(item);
  if (!is_finite(waypoint.position) || !is_finite(waypoint.velocity) ||
      !is_finite(waypoint.acceleration)) {
    return refuse(number, Refusal::not_finite);
  }
  if (!kinds_.takes(waypoint.position)) return refuse(number, Refusal::zero_quaternion);
  if (!window_.takes(waypoint)) return refuse(number, Refusal::lacks_derivatives);
  if (!is_time_in_range(item.time)) return refuse(number, Refusal::too_far_apart);
  if (head_.knots > 0) {
    const auto status = judge_interval(item.time - head_.newest_knot, limits_);
    if (status != AppendStatus::accepted) return refuse(number, to_refusal(status));
  }
  if (!window_.lag_suffices(item.time)) return refuse(number, Refusal::lag_too_short);
  const std::size_t knots = window_.knots();
  kinds_.continue_from(knots > 0 ? window_.knot(knots - 1).waypoint : std::span<const double>{},
                       values_of(item));  // what `waypoint` looks at
  window_.append(waypoint);
  head_.knots = window_.knots();
  head_.newest_knot = item.time;
  // What has settled leaves the window and is written once, with its last value.
  while (settled_written_ < window_.settled_segments()) write_segment(settled_written_++);
}

void StreamSolver::take_finish(const RingItem& item, Word number) noexcept {
  end_.kind = item.condition;
  end_.value.clear();
  const std::size_t dimensions = window_.dimensions();
  if (!core::is_online(item.condition)) {
    return refuse(number, Refusal::unknown_kind);
  }
  const bool is_velocity = item.condition == core::ConditionKind::velocity;
  if (is_velocity || item.condition == core::ConditionKind::acceleration) {
    const auto values =
        std::span(item.values).subspan((is_velocity ? 1 : 2) * dimensions, dimensions);
    if (!is_finite(values)) return refuse(number, Refusal::not_finite);
    end_.value.assign(values.begin(), values.end());
  }
  window_.finish(end_);
  head_.finished = true;
}

void StreamSolver::refuse(Word number, Refusal reason) noexcept {
  board_->write_refusal(head_.refused++, {.item = number, .reason = reason});
  ++head_.reasons[static_cast<std::size_t>(reason)];
}

void StreamSolver::write_segment(std::size_t i) noexcept {
  window_.segment(i, segment_);
  head_.changed_from = std::min(head_.changed_from, segment_.left);
  board_->write(i + 1, segment_, window_.knot(i), window_.newer_knots_seen(i));
}

void StreamSolver::publish(const Clock& clock) noexcept {
  const std::size_t segments = window_.segments();
  for (std::size_t i = settled_written_; i < segments; ++i) write_segment(i);
  if (segments > 0) {
    head_.newest = segments;
    // Never back: a finish drops the stop tail, but the slot that it took is not given back.
    head_.first =
        std::max<Word>(head_.first, segments - std::min<Word>(segments, board_->capacity()) + 1);
    const std::size_t open = window_.settled_segments();
    head_.settled_until = window_.knot(std::min(open, window_.knots() - 1)).time;
  }
  head_.committed = clock.now();
  board_->commit(head_);
  board_->store_tail(head_.consumed);
}

}  // namespace splinecast::ipc
