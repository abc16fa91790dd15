#include "apps/record/output/recording_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/format/options.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {
namespace {

constexpr std::string_view kJson = "json";
constexpr std::string_view kJsonSchema = "jsonschema";
constexpr mode_t kMode = 0600;
/// Uncompressed size at which a chunk ends. Only between two records, so that a whole chunk has
/// whole records: the writer itself ends none.
constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

int create(const std::string& path) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (descriptor >= 0) return descriptor;
  throw Failure(fmt::format("cannot create {}: {}", ipc::printable(path), std::strerror(errno)));
}

std::string_view text_of(std::span<const std::byte> bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // NOLINT(*-reinterpret-cast)
}

/// The metadata of a stream: the members of its options, each as JSON text.
std::map<std::string, std::string> metadata_of(std::string_view options) {
  std::map<std::string, std::string> values;
  const auto object = nlohmann::json::parse(options);
  for (const auto& [name, value] : object.items()) {
    values[name] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  return values;
}

}  // namespace

RecordingFile::Stream::Stream(const StreamOptions& options, const SamplingRate& rate)
    : dimensions(options.waypoints.dimensions), json(options.waypoints) {
  if (rate.hz > 0) sampled.emplace(options.waypoints, rate);
}

RecordingFile::RecordingFile(std::string path, const FileOptions& options)
    : path_(std::move(path)), options_(options), descriptor_(create(path_)), id_(file_id(path_)) {
  const auto write = [this](std::span<const std::byte> bytes) { return write_bytes(bytes); };
  writer_ = std::make_unique<mcap::Writer>(
      write, mcap::WriterOptions{
                 .profile = "", .compression = options_.compression, .chunk_bytes = kNever});
}

RecordingFile::~RecordingFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool RecordingFile::write_bytes(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      why_ = std::strerror(count < 0 ? errno : ENOSPC);
      cut_to_whole_chunks();
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    // After a signal what waits is still written: its size has a bound, and the disk may be slow.
    extend_shutdown();
  }
  return true;
}

/// Removes the part of a chunk that was written.
void RecordingFile::cut_to_whole_chunks() noexcept {
  const auto whole = writer_ ? static_cast<off_t>(writer_->bytes()) : 0;
  if (ftruncate(descriptor_, whole) != 0) return;  // a reader stops at the last whole chunk
}

std::uint16_t RecordingFile::add_channel(const std::string& topic, std::string_view schema,
                                         const std::string& text) {
  const bool is_json = !text.empty();
  std::uint16_t id = 0;
  if (is_json) {
    const auto [known, is_new] = schemas_.try_emplace(fmt::format("{}\n{}", schema, text));
    if (is_new) known->second = writer_->add_schema(schema, kJsonSchema, text);
    id = known->second;
  }
  const std::string key = fmt::format("{}\n{}", topic, id);
  if (const auto found = channels_.find(key); found != channels_.end()) return found->second;
  const std::uint16_t channel = writer_->add_channel(id, topic, is_json ? kJson : "splinecast", {});
  channels_.emplace(key, channel);
  sequences_.resize(channel + std::size_t{1});
  return channel;
}

void RecordingFile::begin_stream(const Record& record) {
  const std::string_view text = text_of(std::span(record.bytes).subspan(1));
  const StreamOptions options = parse_options(text);
  Stream stream(options, options_.states);
  stream.id = record.number;
  const std::string topic = "/" + options.stream;
  stream.waypoints =
      add_channel(topic + "/waypoints", "splinecast.Waypoint", stream.json.waypoint_schema());
  stream.events = add_channel(topic + "/events", "splinecast.Event", JsonMessages::event_schema());
  if (stream.sampled) {
    stream.states = add_channel(topic + "/states", "splinecast.State", stream.json.state_schema());
  }
  stream.exact = add_channel(topic + "/splinecast", "", "");
  writer_->add_metadata("splinecast:" + options.stream, metadata_of(text));
  streams_.insert_or_assign(record.stream, std::move(stream));
}

void RecordingFile::write(const Record& record) {
  write_messages(record);
  if (writer_->open_bytes() >= kChunkBytes) end_chunk();
}

void RecordingFile::write_messages(const Record& record) {
  if (record.kind == RecordKind::options) begin_stream(record);
  const auto found = streams_.find(record.stream);
  if (found == streams_.end()) throw BadMessage("its stream has no options");
  Stream& stream = found->second;
  if (record.kind == RecordKind::event) {
    return put(stream.events, record.own_time, record.seen, record.bytes);
  }
  put(stream.exact, record.own_time, record.seen, record.bytes);
  const auto body = std::span<const std::byte>(record.bytes).subspan(1);
  if (record.kind == RecordKind::item) {
    const NumberedItem item = decode_item(body, stream.dimensions);
    put(stream.waypoints, record.own_time, record.seen, stream.json.waypoint(item));
  } else if (record.kind == RecordKind::segment && stream.sampled) {
    put_states(stream, record);
  }
}

void RecordingFile::put_states(Stream& stream, const Record& record) {
  const auto body = std::span<const std::byte>(record.bytes).subspan(1);
  const auto [left, right] = times_of_segment(body);
  if (!stream.sampled->has_any(left, right)) return;
  const ipc::SegmentCopy segment = decode_segment(body, stream.dimensions);
  stream.sampled->sample(segment, [&](Time time, const State& state) {
    const double part = to_seconds(time - segment.left) / to_seconds(segment.right - segment.left);
    const Time own =
        record.own_time + from_seconds(part * to_seconds(record.own_end - record.own_time));
    put(stream.states, own, record.seen, stream.json.state(time, segment.kind, state));
  });
}

void RecordingFile::put(std::uint16_t channel, Time own_time, Time seen,
                        std::span<const std::byte> data) {
  writer_->write(channel, sequences_.at(channel)++, seen, own_time, data);
}

void RecordingFile::put(std::uint16_t channel, Time own_time, Time seen, std::string_view text) {
  put(channel, own_time, seen, std::as_bytes(std::span(text)));
}

void RecordingFile::end_chunk() { writer_->end_chunk(); }

void RecordingFile::finish() {
  writer_->finish();
  if (close(std::exchange(descriptor_, -1)) != 0 && why_.empty()) why_ = std::strerror(errno);
}

bool RecordingFile::is_in_place() const noexcept { return file_id(path_) == id_; }

FileId file_id(const std::string& path) noexcept {
  struct stat named {};
  if (stat(path.c_str(), &named) != 0) return std::nullopt;
  return std::pair(named.st_dev, named.st_ino);
}

}  // namespace splinecast::apps::record
