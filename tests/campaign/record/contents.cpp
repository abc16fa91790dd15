#include "tests/campaign/record/contents.hpp"

#include <algorithm>
#include <span>
#include <string_view>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/record/format/messages.hpp"
#include "tests/campaign/record/source.hpp"

namespace splinecast::campaign::record {
namespace {

using apps::record::Account;
using apps::record::Loss;
using apps::record::RecordKind;

/// Whether a source may have sent an item with these values.
bool is_sent(const ipc::RingItem& item) noexcept {
  if (item.kind != ipc::ItemKind::waypoint) return true;
  const auto values = apps::record::values_of(item).position;
  const auto has_motion = [&](bool is_replacement) {
    for (std::size_t d = 0; d < values.size(); ++d) {
      if (values[d] != position_at(item.time, d, is_replacement)) return false;
    }
    return true;
  };
  return has_motion(false) || has_motion(true);
}

/// Whether the account of a stream is newer. A file that is begun by a trigger has an account of
/// that time, and then records that are older.
bool is_newer(const StreamContents& a, const StreamContents& b) noexcept {
  if (!a.account || !b.account) return a.account.has_value();
  const auto end = [](const Account& account) { return account.items.end + account.segments.end; };
  return std::pair(end(*a.account), a.account_time) > std::pair(end(*b.account), b.account_time);
}

/// Reads the exact channels of a file.
class ContentsReader {
 public:
  void take(const apps::mcap::Message& message) {
    const RecordKind kind = apps::record::kind_of(message.data);
    const auto body = message.data.subspan(1);
    if (kind == RecordKind::options) return take_options(*message.channel, body);
    auto& [stream, dimensions] = channels_.at(message.channel->topic);
    if (kind == RecordKind::item) {
      const auto item = apps::record::decode_item(body, dimensions);
      stream->items.recorded.add({.first = item.number, .count = 1});
      if (!stream->is_law && !is_sent(item.item)) ++found_.wrong;
    } else if (kind == RecordKind::segment) {
      const auto segment = apps::record::decode_segment(body, dimensions);
      const ipc::Word next = std::max(segment.next, segment.number + 1);
      stream->segments.recorded.add({.first = segment.number - 1, .count = next - segment.number});
    } else if (kind == RecordKind::loss) {
      take_loss(*stream, apps::record::decode_loss(body));
    } else if (kind == RecordKind::account) {
      stream->account = apps::record::decode_account(body);
      stream->account_time = message.log_time;
    }
  }

  FileContents finish() {
    for (auto& [key, stream] : found_.streams) {
      for (Numbers* const numbers : {&stream.items, &stream.segments}) {
        found_.repeated += numbers->recorded.tidy() + numbers->lost.tidy();
      }
    }
    return std::move(found_);
  }

 private:
  void take_options(const apps::mcap::Channel& channel, std::span<const std::byte> body) {
    const auto options = apps::record::parse_options(
        {reinterpret_cast<const char*>(body.data()), body.size()});  // NOLINT
    StreamContents& stream = found_.streams[{options.stream, options.waypoints.stream_id}];
    stream.is_law = options.stream.ends_with(kLawName);
    stream.has_solver = stream.has_solver || options.spline;
    channels_.insert_or_assign(channel.topic, std::pair(&stream, options.waypoints.dimensions));
  }

  void take_loss(StreamContents& stream, const Loss& loss) {
    stream.items.lost.add(loss.items);
    Ranges::Span segments = loss.segments;
    if (segments.count > 0) --segments.first;
    stream.segments.lost.add(segments);
    stream.losses += loss.all();
    found_.losses += loss.all();
  }

  FileContents found_;
  std::map<std::string, std::pair<StreamContents*, std::size_t>, std::less<>> channels_;
};

}  // namespace

FileContents read_contents(const std::string& path) {
  const apps::TextFile file(path);
  apps::mcap::Reader in(path, std::as_bytes(std::span(file.text())));
  ContentsReader contents;
  apps::mcap::Message message;
  while (in.next(message)) {
    if (message.channel->message_encoding == "splinecast") contents.take(message);
  }
  FileContents found = contents.finish();
  found.is_cut_off = in.ended_early();
  return found;
}

void add(Streams& all, const Streams& further) {
  for (const auto& [key, stream] : further) {
    StreamContents& sum = all[key];
    sum.items.recorded.add(stream.items.recorded);
    sum.items.lost.add(stream.items.lost);
    sum.segments.recorded.add(stream.segments.recorded);
    sum.segments.lost.add(stream.segments.lost);
    sum.losses += stream.losses;
    sum.has_solver = sum.has_solver || stream.has_solver;
    if (!is_newer(stream, sum)) continue;
    sum.account = stream.account;
    sum.account_time = stream.account_time;
  }
}

void tidy(Streams& all) {
  for (auto& [key, stream] : all) {
    for (Numbers* const numbers : {&stream.items, &stream.segments}) {
      (void)numbers->recorded.tidy();
      (void)numbers->lost.tidy();
    }
  }
}

}  // namespace splinecast::campaign::record
