#include "apps/record/format/messages.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/options.hpp"
#include "apps/record/verification/recorded_stream.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"

/// Messages of the exact channel, without shared memory.
namespace splinecast::apps::record {
namespace {

constexpr std::size_t kDimensions = 3;

ipc::SegmentCopy a_segment() {
  ipc::SegmentCopy segment{.number = 7, .next = 9};
  segment.left = Time(-5);
  segment.right = Time(10);
  segment.natural_right = Time(12);
  segment.order = 4;
  segment.kind = SegmentKind::entry;
  segment.newer_knots = 8;
  segment.origin = {.right_newer_knots = 3, .item = 11, .ends_at_waypoint = true, .known = 2};
  segment.has_waypoint = true;
  segment.coefficients.assign(4 * kDimensions, -0.0);
  segment.waypoint.assign(kDimensions, 1e300);
  return segment;
}

Restart a_restart() {
  ipc::RestartKnot knot{.time = Time(10)};
  knot.waypoint = knot.g = knot.position = knot.velocity = std::vector<double>(kDimensions, 0.5);
  return {
      .before = a_segment(),
      .first_item = 4,
      .knots = ipc::RunRestart{.is_later_run = true, .run_item = 2, .first = 0, .knots = {knot}}};
}

Published published() {
  ipc::Summary summary;
  summary.finished = true;
  summary.run_item = 3;
  return {.summary = summary, .open = {}};
}

Published published_with_open_segment() {
  Published all = published();
  all.open.emplace(ipc::OpenSegment{.until = Time(9), .segment = a_segment()});
  return all;
}

/// A valid message of each kind, and its decoder.
struct Example {
  Bytes message;
  std::function<Bytes(std::span<const std::byte>)> decode_and_encode;
};

std::vector<Example> examples() {
  ipc::RingItem item(kDimensions);
  item.kind = ipc::ItemKind::start_state;
  item.has_velocity = item.has_acceleration = true;
  item.values = {1, -0.0, 3, std::numeric_limits<double>::denorm_min(), 5, 6, 7, 8, 9};
  ipc::RingItem piece(1);
  piece.kind = ipc::ItemKind::rate;
  piece.has_velocity = piece.has_acceleration = true;
  piece.commander = 15;
  piece.place = 2;
  piece.count = 1;
  piece.values = {0.3, 0.5, std::bit_cast<double>(std::uint64_t{7})};
  const auto body = [](std::span<const std::byte> message) { return message.subspan(1); };
  const auto publish = [=](auto m) { return encode(decode_published(body(m), kDimensions)); };
  return {
      {encode({.number = 12, .is_old = true, .item = item}),
       [=](auto m) {
         const NumberedItem found = decode_item(body(m), kDimensions);
         return encode(found);
       }},
      {encode({.number = 13, .item = piece}),
       [=](auto m) {
         const NumberedItem found = decode_item(body(m), 1);
         EXPECT_EQ(found.item.commander, 15);
         EXPECT_EQ(found.item.place, 2);
         EXPECT_EQ(found.item.request(), 7U);
         return encode(found);
       }},
      {encode(ipc::RefusalRecord{.item = 3, .reason = Refusal::past}),
       [=](auto m) { return encode(decode_refusal(body(m))); }},
      {encode(a_segment()), [=](auto m) { return encode(decode_segment(body(m), kDimensions)); }},
      {encode(a_restart()), [=](auto m) { return encode(decode_restart(body(m), kDimensions)); }},
      {encode(published()), publish},
      {encode(published_with_open_segment()), publish},
      {encode(Loss{.cause = LossCause::file, .items = {.first = 7, .count = 1}, .others = 2}),
       [=](auto m) { return encode(decode_loss(body(m))); }},
      {encode(Account{.items = {.end = 9, .recorded = 5, .unwritten = 1}}),
       [=](auto m) { return encode(decode_account(body(m))); }}};
}

TEST(RecordMessages, ReadBackToTheSameBytes) {
  for (const Example& example : examples()) {
    EXPECT_EQ(example.decode_and_encode(example.message), example.message);
    EXPECT_EQ(kind_of(example.message), static_cast<RecordKind>(example.message[0]));
  }
}

/// The sizes that the message has without what older files do not have: the end and the open
/// segment of a summary, the numbers of a loss.
std::set<std::size_t> older_sizes(const Bytes& message) {
  const std::size_t closed = encode(published()).size();
  if (kind_of(message) == RecordKind::summary) return {closed - 24, closed};
  if (kind_of(message) == RecordKind::loss) return {message.size() - 16};
  return {};
}

TEST(RecordMessages, AreRefusedAtEveryOtherLength) {
  for (const Example& example : examples()) {
    const std::set<std::size_t> older = older_sizes(example.message);
    for (std::size_t size = 1; size < example.message.size(); ++size) {
      if (older.contains(size)) continue;
      EXPECT_THROW((void)example.decode_and_encode(std::span(example.message).first(size)),
                   BadMessage)
          << size;
    }
    Bytes longer = example.message;
    longer.push_back(std::byte{0});
    EXPECT_THROW((void)example.decode_and_encode(longer), BadMessage);
  }
}

StreamOptions some_options() {
  StreamOptions options{.stream = "arm"};
  options.waypoints =
      ipc::make_header({.dimensions = kDimensions,
                        .names = {"a", "b", "\xff"},
                        .kinds = {{DimensionKind::periodic, 6.283185307179586}, {}, {}},
                        .clock = StreamClock::recorded},
                       77);
  options.waypoints.capacity = 64;
  options.spline = options.waypoints;
  ipc::write_options({.settle = 3}, *options.spline);
  return options;
}

TEST(RecordMessages, OptionsReadBack) {
  const StreamOptions options = some_options();
  const std::string text =
      to_json(options).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const StreamOptions found = parse_options(text);
  EXPECT_EQ(to_json(found), nlohmann::ordered_json::parse(text));
  EXPECT_EQ(ipc::window_options(*found.spline).settle, 3U);
  EXPECT_EQ(ipc::dimensions_of(found.waypoints), ipc::dimensions_of(options.waypoints));
}

TEST(RecordMessages, OptionsOfNoStreamAreRefusedByName) {
  const auto refusal = [](const char* path, const nlohmann::json& value) {
    nlohmann::json changed = nlohmann::json::parse(
        to_json(some_options()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    changed[nlohmann::json::json_pointer(path)] = value;
    try {
      (void)parse_options(changed.dump());
      return std::string("accepted");
    } catch (const BadMessage& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal("/format", 3),
            "it was made by a newer version: it has format 3, this program reads formats 1 to 2");
  EXPECT_NE(refusal("/dimensions", nlohmann::json::array()).find("dimensions 0"),
            std::string::npos);
  EXPECT_EQ(refusal("/clock", "moon"), "its field 'clock' is \"moon\"");
  EXPECT_EQ(refusal("/solver/method", "magic"), "its field 'method' is \"magic\"");
  EXPECT_EQ(refusal("/solver/settle", "many"), "its field 'settle' has another type");
  EXPECT_NE(refusal("/solver/settle", 65).find("settle lag 65"), std::string::npos);
  EXPECT_NE(refusal("/capacity", 1e15), "accepted");
  EXPECT_NE(refusal("/start", "periodic"), "accepted");
  EXPECT_NE(refusal("/dimensions/0/period", -1), "accepted");
  EXPECT_NE(refusal("/stream", "../x"), "accepted");
}

TEST(RecordMessages, ASegmentThatIsTooLongForATimeIsRefused) {
  const auto read_back = [](const ipc::SegmentCopy& segment) {
    const Bytes message = encode(segment);
    (void)decode_segment(std::span(message).subspan(1), kDimensions);
  };
  ipc::SegmentCopy segment = a_segment();
  segment.left = -kLatestTime;
  segment.right = segment.natural_right = kLatestTime;
  EXPECT_NO_THROW(read_back(segment));
  segment.left = -2 * kLatestTime;
  segment.right = segment.natural_right = 2 * kLatestTime;
  EXPECT_THROW(read_back(segment), BadMessage);
}

/// Random changes of a stream's messages: an exception or a result, and no crash.
TEST(RecordMessages, AnyBytesAreRefusedOrVerified) {
  std::mt19937_64 random(5);
  std::vector<Bytes> messages;
  Bytes options{static_cast<std::byte>(RecordKind::options)};
  ByteWriter(options).put(std::string_view(
      to_json(some_options()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)));
  for (const Example& example : examples()) messages.push_back(example.message);
  int refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    RecordedStream stream;
    stream.take(options);
    try {
      for (int n = 0; n < 6; ++n) {
        Bytes message = messages[random() % messages.size()];
        for (std::uint64_t flips = random() % 3; flips > 0; --flips) {
          message[1 + random() % (message.size() - 1)] = static_cast<std::byte>(random());
        }
        stream.take(message);
      }
      stream.finish();
    } catch (const BadMessage&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace splinecast::apps::record
