#include "apps/record/output/memory.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace splinecast::apps::record {
namespace {

/// Memory that records of a stream which are older than the window may take. It is only exceeded by
/// a stream in which verification cannot begin, such as one without a solver.
constexpr std::size_t kMostBeyond = std::size_t{16} << 20U;

std::size_t size_of(const Record& record) noexcept { return sizeof(Record) + record.bytes.size(); }

bool is_of_item(const Record& record) noexcept {
  return record.kind == RecordKind::item || record.kind == RecordKind::refusal;
}

}  // namespace

void RecordMemory::add(Record record, const Forget& forget) {
  Stream& stream = stream_of(record, forget);
  const std::uint64_t sequence = added_++;
  const Time now = record.seen;
  stream.newest = now;
  stream.has_ended = false;
  if (record.kind == RecordKind::options) {
    stream.options = std::move(record);
    return;
  }
  if (record.kind == RecordKind::restart) {
    stream.starts.push_back({sequence, record.number, now});
  }
  stream.bytes += size_of(record);
  bytes_ += size_of(record);
  auto& list = is_of_item(record) ? stream.items : stream.others;
  list.push_back({sequence, std::move(record)});
  trim(stream, now, forget);
}

/// The stream of a record: a new one for the options of another stream of the same name.
RecordMemory::Stream& RecordMemory::stream_of(const Record& record, const Forget& forget) {
  const auto [first, last] = streams_.equal_range(record.stream);
  const auto newest = first != last ? std::prev(last) : streams_.end();
  const bool is_new =
      newest == streams_.end() || (record.kind == RecordKind::options && newest->second.options &&
                                   newest->second.options->number != record.number);
  if (!is_new) return newest->second;
  drop_old(record.stream, record.seen - window_, forget);
  return streams_.emplace(record.stream, Stream{})->second;
}

/// Forgets the streams of a number that have no record since `oldest`.
void RecordMemory::drop_old(std::uint32_t number, Time oldest, const Forget& forget) {
  const auto [first, last] = streams_.equal_range(number);
  for (auto at = first; at != last;) {
    Stream& stream = at->second;
    if (stream.newest > oldest) {
      ++at;
      continue;
    }
    empty(stream, forget);
    at = may_erase(stream) ? streams_.erase(at) : std::next(at);
  }
}

void RecordMemory::empty(Stream& stream, const Forget& forget) {
  for (auto* const list : {&stream.items, &stream.others}) {
    while (!list->empty() && may_forget(list->front())) pop(stream, *list, forget);
  }
}

bool RecordMemory::may_forget_before(std::uint64_t sequence) const noexcept {
  return bytes_ > kMostHeld || (!holds_ && sequence <= needed_from_);
}

bool RecordMemory::may_forget(const Kept& kept) const noexcept {
  return bytes_ > kMostHeld || (!holds_ && kept.sequence < needed_from_);
}

bool RecordMemory::may_erase(const Stream& stream) const noexcept {
  const bool keeps_options = holds_ && streams_.size() <= kMostEmpty;
  return stream.items.empty() && stream.others.empty() && !keeps_options;
}

bool RecordMemory::has(std::uint32_t stream, ipc::Word id) const {
  const auto [first, last] = streams_.equal_range(stream);
  return std::any_of(first, last, [id](const auto& entry) {
    const Stream& kept = entry.second;
    return kept.options && kept.options->number == id &&
           !(kept.items.empty() && kept.others.empty());
  });
}

void RecordMemory::end(std::uint32_t stream) noexcept {
  const auto [first, last] = streams_.equal_range(stream);
  if (first != last) std::prev(last)->second.has_ended = true;
}

void RecordMemory::tidy(Time now, const Forget& forget) {
  for (auto at = streams_.begin(); at != streams_.end();) {
    Stream& stream = at->second;
    trim(stream, now, forget);
    const bool is_old = stream.has_ended && stream.newest <= now - window_;
    if (is_old) empty(stream, forget);
    at = is_old && may_erase(stream) ? streams_.erase(at) : std::next(at);
  }
}

void RecordMemory::trim(Stream& stream, Time now, const Forget& forget) {
  const Time oldest = now - window_;
  // The newest start that is old enough is the one from which everything is kept. What is needed
  // has a start before it, else it could not be verified.
  while (stream.starts.size() > 1 && stream.starts[1].seen <= oldest &&
         may_forget_before(stream.starts[1].sequence)) {
    stream.starts.pop_front();
  }
  const bool has_start = !stream.starts.empty() && stream.starts.front().seen <= oldest;
  if (has_start) {
    const Start& start = stream.starts.front();
    while (!stream.items.empty() && stream.items.front().record.number < start.first_item &&
           may_forget(stream.items.front())) {
      pop(stream, stream.items, forget);
    }
    while (!stream.others.empty() && stream.others.front().sequence < start.sequence &&
           may_forget(stream.others.front())) {
      pop(stream, stream.others, forget);
    }
  }
  for (auto* const list : {&stream.items, &stream.others}) {
    while (stream.bytes > kMostBeyond && !list->empty() && list->front().record.seen < oldest &&
           may_forget(list->front())) {
      pop(stream, *list, forget);
    }
  }
}

void RecordMemory::pop(Stream& stream, std::deque<Kept>& from, const Forget& forget) {
  const Kept& front = from.front();
  stream.bytes -= size_of(front.record);
  bytes_ -= size_of(front.record);
  if (forget) {
    forget(front.record, front.sequence, stream.options ? stream.options->number : 0);
  }
  from.pop_front();
}

void RecordMemory::clear(const Forget& forget) {
  holds_ = false;
  needed_from_ = kNone;
  while (!streams_.empty()) drop_old(streams_.begin()->first, Time::max(), forget);
}

void RecordMemory::give(Extent extent,
                        const std::function<void(const Record& record)>& take) const {
  for (const auto& [number, stream] : streams_) {
    if (!stream.options) continue;
    const bool is_short = extent == Extent::newest_start;
    const bool has_start = !stream.starts.empty();
    const Start none{.sequence = needed_from_, .first_item = 0, .seen = {}};
    const Start from = !is_short ? Start{} : has_start ? stream.starts.back() : none;
    take(*stream.options);
    for (const Kept& kept : stream.items) {
      const bool is_new = has_start || kept.sequence >= from.sequence;
      if (is_new && kept.record.number >= from.first_item) take(kept.record);
    }
    for (const Kept& kept : stream.others) {
      if (kept.sequence >= from.sequence) take(kept.record);
    }
  }
}

}  // namespace splinecast::apps::record
