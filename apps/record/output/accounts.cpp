#include "apps/record/output/accounts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {
namespace {

/// Counts numbers that have been read. Numbers that were skipped without a loss count as missed.
/// Returns whether any of them is new.
bool count(Account::Numbers& numbers, LossCounts& missed, ipc::Word LossCounts::*member,
           const NumberSpan& read) noexcept {
  const NumberSpan rest = read.from(numbers.end);
  if (rest.count == 0) return false;
  missed.*member += rest.first - numbers.end;
  numbers.recorded += rest.count;
  numbers.end = rest.end();
  return true;
}

void count_lost(Account::Numbers& numbers, ipc::Word& lost, const NumberSpan& range) noexcept {
  const NumberSpan rest = range.from(numbers.end);
  if (rest.count == 0) return;
  lost += rest.count;
  numbers.end = rest.end();
}

NumberSpan range_of(const Record& record) noexcept {
  return {.first = record.number, .count = record.next - record.number};
}

/// A segment's numbers begin with 1.
NumberSpan moved(NumberSpan range, ipc::Word before) noexcept {
  if (range.count > 0) range.first += before - 1;
  return range;
}

std::string name_in(const Record& options) {
  const auto text = std::span(options.bytes).subspan(1);
  const std::string_view whole(reinterpret_cast<const char*>(text.data()), text.size());  // NOLINT
  return nlohmann::json::parse(whole).value("stream", "");
}

LossCounts& of(Account& account, LossCause cause) {
  return account.lost.at(static_cast<std::size_t>(cause));
}

}  // namespace

void Accounts::begin(const Record& options) {
  const auto [known, is_first] = present_.try_emplace(options.stream, options.number);
  if (!is_first && known->second != options.number) {
    end(options.stream);
    known->second = options.number;
  }
  const auto [found, is_new] = streams_.try_emplace({options.stream, options.number});
  Stream& stream = found->second;
  if (is_new) stream.name = name_in(options);
  const bool has_solver = options.next != 0;
  if (has_solver && stream.has_solver) stream.segments_before = stream.account.segments.end;
  stream.has_solver = stream.has_solver || has_solver;
  stream.has_ended = false;
  stream.newest = options.seen;
}

void Accounts::add(Record& record) {
  if (record.kind == RecordKind::options) return begin(record);
  Stream& stream = streams_[{record.stream, present(record.stream)}];
  Account& account = stream.account;
  stream.newest = record.seen;
  LossCounts& missed = of(account, LossCause::overwritten);
  switch (record.kind) {
    case RecordKind::item:
      record.is_counted = count(account.items, missed, &LossCounts::items, range_of(record));
      break;
    case RecordKind::segment:
      record.is_counted = count(account.segments, missed, &LossCounts::segments,
                                moved(range_of(record), stream.segments_before));
      break;
    case RecordKind::loss: {
      const Loss loss = decode_loss(std::span(record.bytes).subspan(1));
      LossCounts& lost = of(account, loss.cause);
      count_lost(account.items, lost.items, loss.items);
      count_lost(account.segments, lost.segments, moved(loss.segments, stream.segments_before));
      lost.refusals += loss.refusals;
      lost.others += loss.others;
      break;
    }
    default:
      record.is_counted = true;
  }
  stream.is_changed = true;
}

void Accounts::forget(const Record& record, ipc::Word stream_id, bool was_wanted) {
  if (!record.is_counted) return;
  const auto found = streams_.find({record.stream, stream_id});
  const bool is_there = found != streams_.end();
  Account& account = is_there ? found->second.account : ended_;
  LossCounts& lost = of(account, LossCause::file);
  const ipc::Word count = record.next - record.number;
  if (record.kind == RecordKind::item || record.kind == RecordKind::segment) {
    const bool is_item = record.kind == RecordKind::item;
    Account::Numbers& numbers = is_item ? account.items : account.segments;
    numbers.recorded -= count;
    if (!was_wanted) numbers.unwritten += count;
    if (was_wanted) (is_item ? lost.items : lost.segments) += count;
  } else if (was_wanted) {
    ++(record.kind == RecordKind::refusal ? lost.refusals : lost.others);
  }
  if (is_there) found->second.is_changed = true;
}

void Accounts::end(std::uint32_t stream) noexcept {
  const auto found = streams_.find({stream, present(stream)});
  if (found != streams_.end()) found->second.has_ended = true;
}

void Accounts::tidy(Time oldest, const std::function<bool(const Key& stream)>& needed) {
  std::erase_if(streams_, [&](const auto& entry) {
    const auto& [key, stream] = entry;
    if (!stream.has_ended || stream.newest >= oldest || needed(key)) return false;
    retire(stream);
    if (present(key.first) == key.second) present_.erase(key.first);
    return true;
  });
}

ipc::Word Accounts::present(std::uint32_t stream) const noexcept {
  const auto found = present_.find(stream);
  return found != present_.end() ? found->second : 0;
}

void Accounts::retire(const Stream& stream) {
  ended_ += stream.account;
  if (stream.account.all_lost().all() == 0 || ended_losses_.size() >= kMostNamed) return;
  ended_losses_.push_back(
      fmt::format("'{}': {}", ipc::printable(stream.name), lost_in_words(stream.account.lost)));
}

const Account* Accounts::changed(const Key& stream, bool is_needed) {
  const auto found = streams_.find(stream);
  if (found == streams_.end() || !(found->second.is_changed || is_needed)) return nullptr;
  found->second.is_changed = false;
  return &found->second.account;
}

std::vector<Accounts::Key> Accounts::all_changed() const {
  std::vector<Key> keys;
  for (const auto& [key, stream] : streams_) {
    if (stream.is_changed) keys.push_back(key);
  }
  return keys;
}

Account Accounts::total() const {
  Account sum = ended_;
  for (const auto& [key, stream] : streams_) sum += stream.account;
  return sum;
}

std::vector<std::string> Accounts::losses() const {
  std::vector<std::string> lines = ended_losses_;
  for (const auto& [key, stream] : streams_) {
    if (stream.account.all_lost().all() == 0 || lines.size() >= kMostNamed) continue;
    lines.push_back(
        fmt::format("'{}': {}", ipc::printable(stream.name), lost_in_words(stream.account.lost)));
  }
  return lines;
}

}  // namespace splinecast::apps::record
