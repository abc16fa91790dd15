#include "apps/record/format/loss.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "apps/record/format/bytes.hpp"

namespace splinecast::apps::record {
namespace {

Bytes begin(RecordKind kind) { return {static_cast<std::byte>(kind)}; }

/// Whether two losses can be one range of items and one of segments.
bool joins(const Loss& a, const Loss& b) noexcept {
  return a.items.continues_in(b.items) && a.segments.continues_in(b.segments);
}

void join(NumberSpan& range, const NumberSpan& next) noexcept {
  if (next.count == 0) return;
  if (range.count == 0) range.first = next.first;
  range.count += next.count;
}

/// `range` is consecutive with that of `loss`: see joins().
void join(Loss& loss, const Loss& next) noexcept {
  loss.cause = next.cause;
  join(loss.items, next.items);
  join(loss.segments, next.segments);
  loss.refusals += next.refusals;
  loss.others += next.others;
}

/// Whether a loss is of numbers before those of another one.
bool is_before(const Loss& a, const Loss& b) noexcept {
  if (a.items.count > 0 && b.items.count > 0) return a.items.first < b.items.first;
  return a.segments.count > 0 && b.segments.count > 0 && a.segments.first < b.segments.first;
}

Account::Numbers& operator+=(Account::Numbers& sum, const Account::Numbers& other) noexcept {
  sum.end += other.end;
  sum.recorded += other.recorded;
  sum.unwritten += other.unwritten;
  return sum;
}

/// The members of an account without those of the losses, in the order of the message.
template <typename A>
auto numbers_of(A& account) noexcept {
  return std::array{&account.items.end,    &account.items.recorded,    &account.items.unwritten,
                    &account.segments.end, &account.segments.recorded, &account.segments.unwritten};
}

constexpr std::array kCounts{&LossCounts::items, &LossCounts::segments, &LossCounts::refusals,
                             &LossCounts::others};

}  // namespace

std::string_view to_string(LossCause cause) noexcept {
  constexpr std::array<std::string_view, kLossCauses> kNames{"overwritten", "queue full", "disk",
                                                             "late commit", "before attaching"};
  return kNames.at(static_cast<std::size_t>(cause));
}

void NumberSpan::extend(ipc::Word from, ipc::Word to) noexcept {
  join(*this, {.first = from, .count = to - from});
}

NumberSpan NumberSpan::from(ipc::Word least) const noexcept {
  if (least <= first) return *this;
  const ipc::Word last = std::max(end(), least);
  return {.first = least, .count = last - least};
}

void Loss::count(const Record& record) noexcept {
  if (record.kind == RecordKind::item) {
    items.extend(record.number, record.next);
  } else if (record.kind == RecordKind::segment) {
    segments.extend(record.number, record.next);
  } else if (record.kind == RecordKind::refusal) {
    ++refusals;
  } else {
    ++others;
  }
}

Bytes encode(const Loss& loss) {
  Bytes bytes = begin(RecordKind::loss);
  ByteWriter(bytes)
      .put(static_cast<std::uint8_t>(loss.cause))
      .put(loss.items.count)
      .put(loss.segments.count)
      .put(loss.refusals)
      .put(loss.others)
      .put(loss.items.first)
      .put(loss.segments.first);
  return bytes;
}

Loss decode_loss(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto cause = in.take<std::uint8_t>();
  if (cause >= kLossCauses) throw BadMessage(fmt::format("it has cause {}", cause));
  Loss loss{.cause = static_cast<LossCause>(cause)};
  loss.items.count = in.take<ipc::Word>();
  loss.segments.count = in.take<ipc::Word>();
  loss.refusals = in.take<ipc::Word>();
  loss.others = in.take<ipc::Word>();
  if (in.rest().empty()) return loss;  // of format 1
  loss.items.first = in.take<ipc::Word>();
  loss.segments.first = in.take<ipc::Word>();
  in.require_end();
  return loss;
}

void LossList::add(const Loss& loss) {
  auto at = losses_.end();
  while (at != losses_.begin() && is_before(loss, *std::prev(at))) --at;
  if (at != losses_.begin() && std::prev(at)->cause == loss.cause && joins(*std::prev(at), loss)) {
    join(*std::prev(at), loss);
    return;
  }
  losses_.insert(at, loss);
  if (losses_.size() > kMost) shorten();
}

/// Joins two neighbours. What is between two that cannot be joined is in the recorder's memory,
/// which bounds their number.
void LossList::shorten() {
  for (std::size_t i = 1; i < losses_.size(); ++i) {
    if (!joins(losses_[i - 1], losses_[i])) continue;
    join(losses_[i - 1], losses_[i]);
    losses_.erase(losses_.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

LossCounts& LossCounts::operator+=(const LossCounts& other) noexcept {
  for (const auto member : kCounts) this->*member += other.*member;
  return *this;
}

LossCounts Account::all_lost() const noexcept {
  LossCounts all;
  for (const LossCounts& counts : lost) all += counts;
  return all;
}

Account& Account::operator+=(const Account& other) noexcept {
  items += other.items;
  segments += other.segments;
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] += other.lost[i];
  return *this;
}

Bytes encode(const Account& account) {
  Bytes bytes = begin(RecordKind::account);
  ByteWriter out(bytes);
  for (const ipc::Word* const number : numbers_of(account)) out.put(*number);
  out.put(kLossCauses);
  for (const LossCounts& counts : account.lost) {
    for (const auto member : kCounts) out.put(counts.*member);
  }
  return bytes;
}

Account decode_account(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  Account account;
  for (ipc::Word* const number : numbers_of(account)) *number = in.take<ipc::Word>();
  const auto causes = in.take<std::uint8_t>();
  if (causes != kLossCauses) throw BadMessage(fmt::format("it has {} causes", causes));
  for (LossCounts& counts : account.lost) {
    for (const auto member : kCounts) counts.*member = in.take<ipc::Word>();
  }
  in.require_end();
  return account;
}

nlohmann::ordered_json to_json(const LossCounts& counts) {
  return {{"items", counts.items},
          {"segments", counts.segments},
          {"refusals", counts.refusals},
          {"others", counts.others}};
}

nlohmann::ordered_json reasons_json(const std::array<LossCounts, kLossCauses>& lost) {
  nlohmann::ordered_json reasons = nlohmann::ordered_json::object();
  for (std::size_t cause = 0; cause < lost.size(); ++cause) {
    if (lost.at(cause).all() == 0) continue;
    reasons[to_string(static_cast<LossCause>(cause))] = to_json(lost.at(cause));
  }
  return reasons;
}

std::string lost_in_words(const std::array<LossCounts, kLossCauses>& lost) {
  constexpr std::array<std::string_view, kCounts.size()> kNames{"items", "segments", "refusals",
                                                                "others"};
  std::string text;
  for (std::size_t k = 0; k < kCounts.size(); ++k) {
    ipc::Word sum = 0;
    std::string reasons;
    for (std::size_t cause = 0; cause < lost.size(); ++cause) {
      const ipc::Word count = lost.at(cause).*kCounts.at(k);
      sum += count;
      if (count == 0) continue;
      fmt::format_to(std::back_inserter(reasons), "{}{} {}", reasons.empty() ? "" : ", ",
                     to_string(static_cast<LossCause>(cause)), count);
    }
    if (sum == 0 && k > 0) continue;
    fmt::format_to(std::back_inserter(text), "{}{} {} lost", text.empty() ? "" : ", ", sum,
                   kNames.at(k));
    if (sum > 0) fmt::format_to(std::back_inserter(text), " ({})", reasons);
  }
  return text;
}

}  // namespace splinecast::apps::record
