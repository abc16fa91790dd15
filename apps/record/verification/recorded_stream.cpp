#include "apps/record/verification/recorded_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {

void RecordedStream::take(std::span<const std::byte> message) {
  const RecordKind kind = kind_of(message);
  const auto body = message.subspan(1);
  if (kind == RecordKind::options) return take_options(body);
  if (!options_) throw BadMessage("the options of the stream are not before it");
  const std::size_t dimensions = options_->waypoints.dimensions;
  switch (kind) {
    case RecordKind::item:
      return take_item(decode_item(body, dimensions));
    case RecordKind::refusal: {
      const auto found = items_.find(decode_refusal(body).item);
      if (found != items_.end()) found->second.is_refused = true;
      return;
    }
    case RecordKind::segment:
      return take_segment(decode_segment(body, dimensions));
    case RecordKind::restart:
      return take_restart(decode_restart(body, dimensions));
    case RecordKind::summary:
      summary_ = decode_published(body, dimensions).summary;
      return;
    case RecordKind::account:
      return take_account(decode_account(body));
    default:
      return take_loss(decode_loss(body));
  }
}

void RecordedStream::finish() {
  end_part();
  settle_account();
}

/// Begins another stream, unless it is the same one whose solver has come.
void RecordedStream::take_options(std::span<const std::byte> body) {
  StreamOptions options = parse_options(body);
  const bool is_same = options_ && !options_->spline && part_ == std::nullopt &&
                       options_->waypoints.stream_id == options.waypoints.stream_id &&
                       options_->waypoints.dimensions == options.waypoints.dimensions;
  if (!is_same) {
    end_part();
    if (options_ && options_->waypoints.stream_id != options.waypoints.stream_id) settle_account();
    items_.clear();
    items_end_ = complete_from_ = 0;
    summary_ = {};
    next_segment_ = 1;
  }
  options_ = std::move(options);
}

void RecordedStream::take_item(NumberedItem item) {
  const bool is_first = items_.empty();
  ++found_.items;
  if (!first_ || item.number < *first_) first_ = account_ ? item.number : 0;
  covered_.add({.first = item.number, .count = 1});
  if (!is_first && item.number < items_end_) return;  // read before a file was begun
  if (is_first || item.number != items_end_) {
    end_part();
    complete_from_ = item.number;
  }
  items_end_ = item.number + 1;
  items_.emplace_hint(items_.end(), item.number, Item{std::move(item.item)});
}

bool RecordedStream::has_items_from(ipc::Word first) const noexcept {
  return first >= complete_from_ && first <= items_end_;
}

void RecordedStream::take_segment(ipc::SegmentCopy segment) {
  ++found_.segments;
  if (!options_->spline) throw BadMessage("the options of the solver are not before it");
  const bool follows = segment.number == next_segment_;
  if (part_ && !follows) end_part();
  const bool is_first = segment.number == 1 && complete_from_ == 0 && !items_.empty();
  if (!part_ && is_first) begin(std::nullopt);
  next_segment_ = segment.next;
  if (part_) part_->segments.push_back(std::move(segment));
}

void RecordedStream::take_restart(Restart restart) {
  if (!options_->spline) throw BadMessage("the options of the solver are not before it");
  const bool is_sound =
      !restart.knots || ipc::is_sound(*restart.knots, options_->waypoints.dimensions,
                                      ipc::window_options(*options_->spline));
  if (!is_sound) throw BadMessage("its knots cannot continue a curve");
  const bool continues = part_ && restart.before.next == next_segment_;
  if (continues && part_->segments.size() < kMostSegments) return;
  if (!has_items_from(restart.first_item)) return;
  end_part();
  begin(std::move(restart));
}

void RecordedStream::take_loss(const Loss& loss) {
  found_.lost.at(static_cast<std::size_t>(loss.cause)) +=
      LossCounts{.items = loss.items.count,
                 .segments = loss.segments.count,
                 .refusals = loss.refusals,
                 .others = loss.others};
  covered_.add(loss.items);
  if (loss.cause == LossCause::late_commit) ++found_.late_commits;
  if (loss.items.count + loss.refusals > 0) complete_from_ = items_end_;
  end_part();
}

/// A file that continues another one begins with an account of what is before it.
void RecordedStream::take_account(const Account& account) {
  if (!account_ && !first_) first_ = account.items.end;
  account_ = account;
}

void RecordedStream::settle_account() {
  if (account_) {
    // Items that came after the last account are there, too.
    const ipc::Word end = std::max(account_->items.end, covered_.end());
    found_.sent = found_.sent.value_or(0) + end;
    found_.unaccounted += covered_.missing(first_.value_or(0), end);
  }
  covered_ = {};
  first_.reset();
  account_.reset();
}

void RecordedStream::begin(std::optional<Restart> restart) {
  Part& part = part_.emplace();
  if (restart) {
    items_.erase(items_.begin(), items_.lower_bound(restart->first_item));
    part.segments.push_back(restart->before);
    next_segment_ = restart->before.next;
  }
  part.restart = std::move(restart);
}

void RecordedStream::end_part() {
  if (!part_) return;
  if (!found_.first) verify_part();
  part_.reset();
}

ipc::SentItems RecordedStream::sent_items() const {
  const ipc::Word first = items_.empty() ? items_end_ : items_.begin()->first;
  ipc::SentItems sent(options_->waypoints.dimensions, first);
  for (const auto& [number, item] : items_) {
    sent.add(item.item.kind, values_of(item.item), item.item.count);
    if (item.is_refused) sent.refuse(number);
  }
  return sent;
}

/// The end condition of the finish that the solver took.
Condition RecordedStream::end() const {
  const auto is_taken = [](const auto& entry) {
    return entry.second.item.kind == ipc::ItemKind::finish && !entry.second.is_refused;
  };
  const auto finish = std::ranges::find_if(items_, is_taken);
  return finish != items_.end() ? condition_of(finish->second.item) : Condition{};
}

void RecordedStream::verify_part() {
  ++found_.parts;
  const Part& part = *part_;
  const ipc::SentItems items = sent_items();
  // A summary describes the end of the stream only if the part has its last segment.
  ipc::Summary summary = summary_;
  summary.finished = summary.finished && next_segment_ >= summary.newest;
  try {
    const ipc::Verification found = ipc::verify(
        {.window = ipc::window_options(*options_->spline),
         .kinds = ipc::dimension_kinds(*options_->spline),
         .items = items,
         .segments = part.segments,
         .summary = summary,
         .end = end(),
         .is_part = part.restart.has_value(),
         .restart = part.restart && part.restart->knots ? &*part.restart->knots : nullptr,
         .rules = options_->spline->rules});
    found_.equal += found.equal;
    found_.first = found.first;
  } catch (const std::invalid_argument& error) {
    throw BadMessage(fmt::format("the options of the stream are not valid: {}", error.what()));
  }
}

}  // namespace splinecast::apps::record
