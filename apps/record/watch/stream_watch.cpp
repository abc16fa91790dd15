#include "apps/record/watch/stream_watch.hpp"

#include <fmt/format.h>

#include <utility>

#include "apps/record/watch/events.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps::record {

StreamWatch::StreamWatch(std::uint32_t number, std::string stream, const Trust& trust,
                         Time wall_offset)
    : number_(number), stream_(std::move(stream)), trust_(trust), wall_offset_(wall_offset) {}

bool StreamWatch::attach(Batch& batch, bool was_there) {
  const bool had_ring = is_attached();
  const bool had_board = board_ != nullptr;
  try {
    if (!had_ring) attach_ring(batch);
    if (is_attached() && !had_board) attach_board(batch, was_there);
  } catch (const NoSuchStream&) {  // it does not exist yet, or was just removed
  }
  return is_attached() != had_ring || (board_ != nullptr) != had_board;
}

void StreamWatch::attach_ring(Batch& batch) {
  auto region = ipc::open_ring(stream_, false, trust_);
  auto times = std::make_unique<StreamTimes>(region.header, wall_offset_);
  times->find_law(region.header, trust_);
  auto ring = std::make_unique<RingWatch>(number_, std::move(region), *times);
  if (ring->is_retired()) return;  // its name will be removed
  times_ = std::move(times);
  ring_ = std::move(ring);
  was_finished_ = false;
  owners_.ring = ring_->owner();
  put_options(batch);
  add_event(batch, {.stream = number_, .kind = EventKind::attached},
            times_->stream_time(batch.now, Time::zero()), batch.now,
            fmt::format(R"("role":"producer","pid":{},"epoch":{})", owners_.ring.second,
                        owners_.ring.first));
}

void StreamWatch::attach_board(Batch& batch, bool was_there) {
  if (!ipc::region_exists(stream_, ipc::RegionKind::spline)) return;
  auto board = ipc::open_board(stream_, false, trust_);
  if (board.header.stream_id != ring_->header().stream_id) return;  // of an earlier stream
  if (ipc::KnotBoardReader(board.region.bytes(), board.layout).retired()) return;
  times_->find_law(board.header, trust_);
  board_ = std::make_unique<BoardWatch>(number_, std::move(board), *ring_, *times_);
  owners_.board = board_->owner();
  put_options(batch);
  board_->put_event(batch, EventKind::attached,
                    fmt::format(R"("role":"solver","pid":{},"epoch":{})", owners_.board.second,
                                owners_.board.first));
  if (was_there) board_->look_back(batch);
}

void StreamWatch::put_options(Batch& batch) const {
  StreamOptions options{.stream = stream_, .waypoints = ring_->header()};
  options.wall_offset = times_->offset();
  if (board_) options.spline = board_->header();
  const std::string text =
      to_json(options).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  Bytes bytes;
  bytes.push_back(static_cast<std::byte>(RecordKind::options));
  ByteWriter(bytes).put(std::string_view(text));
  batch.add({.stream = number_,
             .kind = RecordKind::options,
             .number = ring_->header().stream_id,
             .next = board_ ? 1U : 0U,
             .own_time = batch.now,
             .bytes = std::move(bytes)});
}

bool StreamWatch::calls() const noexcept {
  return (board_ && board_->calls()) || (ring_ && ring_->calls());
}

void StreamWatch::look(Batch& batch) {
  if (!ring_) return;
  const bool is_retired = ring_->is_retired() || (board_ && board_->is_retired());
  if (board_) {
    board_->look(batch);
  } else {
    ring_->look(batch);
  }
  if (is_retired) detach(batch, ring_->is_retired() ? "producer" : "solver");
}

void StreamWatch::look_at_owners(Batch& batch) {
  const auto compare = [&](const auto& now, auto& known, const char* role) {
    if (now.first == known.first) return;
    known = now;
    add_event(batch, {.stream = number_, .kind = EventKind::takeover},
              times_->stream_time(batch.now, Time::zero()), batch.now,
              fmt::format(R"("role":"{}","pid":{},"epoch":{})", role, now.second, now.first));
  };
  if (ring_) compare(ring_->owner(), owners_.ring, "producer");
  if (board_) compare(board_->owner(), owners_.board, "solver");
}

/// Detaches from a stream, or from its board only if the ring stays.
void StreamWatch::detach(Batch& batch, const char* role) {
  if (board_) board_->put_summary(batch);
  add_event(batch, {.stream = number_, .kind = EventKind::retired},
            times_->stream_time(batch.now, Time::zero()), batch.now,
            fmt::format(R"("role":"{}")", role));
  was_finished_ = is_finished();
  board_.reset();
  ring_.reset();
}

}  // namespace splinecast::apps::record
