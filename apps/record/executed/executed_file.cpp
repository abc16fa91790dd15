#include "apps/record/executed/executed_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/record/executed/exact_messages.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {
namespace {

/// Collects the messages of a stream's exact channel.
class StreamMessages {
 public:
  void take(const mcap::Message& message) {
    const RecordKind kind = kind_of(message.data);
    const auto body = message.data.subspan(1);
    if (kind == RecordKind::options) return take_options(body);
    if (!options_) throw BadMessage("the options of the stream are not before it");
    const std::size_t dimensions = options_->waypoints.dimensions;
    if (kind == RecordKind::item) return take_item(decode_item(body, dimensions), message);
    if (kind == RecordKind::refusal) return take_refusal(decode_refusal(body));
    if (kind == RecordKind::segment) return curve().take(decode_segment(body, dimensions));
    if (kind == RecordKind::restart && curve().is_empty()) {
      curve().take(decode_restart(body, dimensions).before);
    }
    if (kind == RecordKind::summary) {
      curve().take(decode_published(body, dimensions), host_time(message));
    }
  }

  [[nodiscard]] std::size_t lives() const noexcept { return lives_; }
  [[nodiscard]] std::optional<ExecutedCurve>& found() noexcept { return curve_; }

  [[nodiscard]] std::vector<SentWaypoint> waypoints() {
    std::vector<SentWaypoint> sent;
    for (auto& [number, waypoint] : waypoints_) sent.push_back(std::move(waypoint));
    return sent;
  }

 private:
  [[nodiscard]] ExecutedCurve& curve() {
    if (!curve_) throw BadMessage("the options of the solver are not before it");
    return *curve_;
  }

  /// In format 1, log time and publish time are exchanged.
  [[nodiscard]] Time seen(const mcap::Message& message) const noexcept {
    return options_->format == 1 ? message.publish_time : message.log_time;
  }
  [[nodiscard]] Time host_time(const mcap::Message& message) const noexcept {
    return seen(message) - options_->wall_offset;
  }

  void take_options(std::span<const std::byte> body) {
    StreamOptions options = parse_options(body);
    const bool is_new = !options_ || options_->waypoints.stream_id != options.waypoints.stream_id;
    if (is_new) waypoints_.clear();
    if (options.spline) {
      if (is_new || !curve_) {
        curve_.emplace(options);
        ++lives_;
      }
      curve_->set_options(options);
    } else if (is_new) {
      curve_.reset();
    }
    options_ = std::move(options);
  }

  void take_item(NumberedItem numbered, const mcap::Message& message) {
    if (numbered.item.kind != ipc::ItemKind::waypoint) return;
    const Waypoint values = values_of(numbered.item);
    const bool is_late = is_live(ipc::stream_clock(options_->waypoints)) && !numbered.is_old &&
                         message.log_time > message.publish_time && options_->format > 1;
    waypoints_.try_emplace(
        numbered.number,
        SentWaypoint{.item = numbered.number,
                     .time = numbered.item.time,
                     .position = {values.position.begin(), values.position.end()},
                     .late = is_late ? message.log_time - message.publish_time : Time::zero()});
  }

  void take_refusal(const ipc::RefusalRecord& refused) {
    const auto found = waypoints_.find(refused.item);
    if (found != waypoints_.end()) found->second.is_refused = true;
  }

  std::optional<StreamOptions> options_;
  std::optional<ExecutedCurve> curve_;
  std::size_t lives_ = 0;
  std::map<ipc::Word, SentWaypoint> waypoints_;
};

std::string list_of(const std::vector<std::string>& streams) {
  constexpr std::size_t kMostListed = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(streams.size(), kMostListed); ++i) {
    text += fmt::format("{}'{}'", i == 0 ? "" : ", ", ipc::printable(streams[i]));
  }
  if (streams.size() > kMostListed)
    text += fmt::format(" and {} more", streams.size() - kMostListed);
  return text;
}

}  // namespace

ExecutedStream read_executed(const std::string& path, const std::string& stream) {
  StreamMessages messages;
  const ExactFile file =
      read_exact(path, stream,
                 [&](std::string_view /*name*/, const auto& message) { messages.take(message); });
  if (!file.has_messages) {
    const auto there = executed_streams(path);
    throw InputError(fmt::format(
        "{}: it has no recorded stream '{}'; {}", ipc::printable(path), ipc::printable(stream),
        there.empty() ? "it has no stream that 'record' wrote" : "it has " + list_of(there)));
  }
  if (!messages.found()) {
    throw InputError(fmt::format("{}: stream '{}' had no solver: it has no curve",
                                 ipc::printable(path), ipc::printable(stream)));
  }
  return {.file = file.name,
          .ended_early = file.ended_early,
          .lives = messages.lives(),
          .curve = std::move(*messages.found()),
          .waypoints = messages.waypoints()};
}

std::vector<std::string> executed_streams(const std::string& path) {
  std::map<std::string, bool, std::less<>> streams;  // whether they have a curve
  (void)read_exact(path, {}, [&](std::string_view name, const mcap::Message& message) {
    if (kind_of(message.data) != RecordKind::options) return;
    const StreamOptions options = parse_options(message.data.subspan(1));
    streams[std::string(name)] = options.spline && options.waypoints.is_law == 0;
  });
  std::vector<std::string> names;
  for (const auto& [name, has_curve] : streams) {
    if (has_curve) names.push_back(name);
  }
  return names;
}

std::optional<ExecutedCurve> read_law(const std::string& path, const ExecutedCurve& curve) {
  const ipc::RegionHeader& header = curve.header();
  StreamMessages messages;
  (void)read_exact(path, ipc::text_of(header.law),
                   [&](std::string_view /*name*/, const auto& message) { messages.take(message); });
  std::optional<ExecutedCurve> law = std::move(messages.found());
  const bool is_it = law && law->header().stream_id == header.law_id && !law->is_empty();
  return is_it ? std::move(law) : std::nullopt;
}

void say_what_is_missing(const ExecutedStream& stream) {
  const std::string& name = stream.curve.options().stream;
  if (stream.ended_early) say(fmt::format("{}: it is cut off", stream.file));
  if (stream.lives > 1) {
    say(fmt::format("{}: '{}' was created {} times; this is its newest curve", stream.file, name,
                    stream.lives));
  }
  const auto segments = stream.curve.segments();
  for (std::size_t i = 1; i < segments.size(); ++i) {
    if (segments[i].left == segments[i - 1].right) continue;
    say(fmt::format("{}: '{}': segments are missing from {} ns to {} ns", stream.file, name,
                    segments[i - 1].right.count(), segments[i].left.count()));
  }
}

}  // namespace splinecast::apps::record
