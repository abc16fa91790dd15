#include "apps/replay/sent_rows.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "apps/streams/holders.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {

void SentRows::begin(std::function<void()> require_readable) {
  require_readable_ = std::move(require_readable);
  has_begun_ = true;
  producer_.refusals(found_);
  next_item_ = producer_.appended();
  if (options_.verify) begin_log();
}

/// The waypoints of an earlier producer are unknown, so the later ones cannot be solved again.
void SentRows::begin_log() {
  if (producer_.appended() > 0) {
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer: --verify does not have its earlier "
        "waypoints; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, options_.stream));
  }
  log_.emplace(options_.stream, producer_.stream_id(), options_.ring.trust);
}

void SentRows::note_start(const Waypoint& state) {
  in_ring_.push_back({.number = 0, .loop = 0});
  if (log_) log_->sent_start(state);
}

void SentRows::note_sent(const PlayedRow& row, const Waypoint& waypoint) {
  const bool has_started = producer_.appended() > next_item_ + in_ring_.size() + 1;
  if (sent_ == 0 && has_started && !old_end_.empty()) {
    const std::vector<double> zeros(old_end_.size());
    note_start({.position = old_end_, .velocity = zeros, .acceleration = zeros});
  }
  ++sent_;
  in_ring_.push_back(row);
  if (log_) log_->sent(waypoint);
}

void SentRows::note_replacement(Time t) {
  in_ring_.push_back({.number = 0, .loop = 0});
  if (log_) log_->sent_replacement(t);
}

void SentRows::note_refusal(const PlayedRow& row, Time time, AppendStatus status) {
  ++refused_by_producer_;
  std::string message = fmt::format("{}: waypoint refused: {} (time {} ns)",
                                    recording_.where(row.number), to_string(status), time.count());
  if (status == AppendStatus::stopped) message += ": by " + quoted(producer_.stopped_by());
  note({.by = RefusedBy::producer,
        .reason = to_string(status),
        .number = row.number,
        .loop = row.loop + 1},
       message);
}

void SentRows::look() {
  if (log_) log_->look();
  producer_.refusals(found_);
  missed_ += found_.missed;
  for (const ItemRefusal& refused : found_.items) note_refusal(refused);
  for (; next_item_ < found_.consumed && !in_ring_.empty(); ++next_item_) in_ring_.pop_front();
}

void SentRows::finish() {
  look();
  refused_.add_unnamed(missed_);
}

std::optional<ipc::Verification> SentRows::verify(const Condition& end) {
  if (!log_) return std::nullopt;
  return log_->verify(end);
}

void SentRows::note_refusal(const ItemRefusal& refused) {
  if (log_) log_->refused(refused.item);
  RefusedRow row{
      .by = RefusedBy::solver, .reason = to_string(refused.reason), .item = refused.item};
  std::string where = "the end";
  const ipc::Word i = refused.item - next_item_;
  if (i < in_ring_.size() && in_ring_[i].number == 0) {
    where = "the stop at a gap";
  } else if (i < in_ring_.size()) {
    row.number = in_ring_[i].number;
    row.loop = in_ring_[i].loop + 1;
    where = recording_.where(in_ring_[i].number);
  }
  std::string message = fmt::format("{}: waypoint refused by the solver: {} (item {})", where,
                                    row.reason, refused.item);
  if (!refused.by.empty()) message += fmt::format(": by '{}'", refused.by);
  if (refused.excess) {
    row.excess = refused.excess;
    message += ": " + in_words(*refused.excess, recording_.columns().names);
  }
  note(row, message);
}

void SentRows::note(const RefusedRow& row, const std::string& message) {
  refused_.add(row, message);
  if (!options_.skip_bad && !stopped_) stopped_ = row.by;
}

}  // namespace splinecast::apps
