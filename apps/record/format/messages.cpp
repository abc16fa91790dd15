#include "apps/record/format/messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace splinecast::apps::record {
namespace {

constexpr std::uint8_t kHasVelocity = 1;
constexpr std::uint8_t kHasAcceleration = 2;
constexpr std::uint8_t kIsOld = 4;

Bytes begin(RecordKind kind, std::size_t size) {
  Bytes bytes;
  bytes.reserve(size + 1);
  bytes.push_back(static_cast<std::byte>(kind));
  return bytes;
}

/// Throws BadMessage unless an enumerator's number is within its range.
template <typename Enum>
Enum checked(std::uint8_t number, Enum least, Enum most, std::string_view what) {
  if (number < static_cast<std::uint8_t>(least) || number > static_cast<std::uint8_t>(most)) {
    throw BadMessage(fmt::format("it has {} {}", what, number));
  }
  return static_cast<Enum>(number);
}

/// Whether the message of an item has D values in the place of a position. A finish with a velocity
/// or an acceleration has them too, but they mean nothing. A piece of a law has its end rate there.
bool has_position(const ipc::RingItem& item) noexcept {
  return item.kind == ipc::ItemKind::waypoint || item.kind == ipc::ItemKind::start_state ||
         item.kind == ipc::ItemKind::rate ||
         (item.kind == ipc::ItemKind::finish && (item.condition == ConditionKind::velocity ||
                                                 item.condition == ConditionKind::acceleration));
}

}  // namespace

RecordKind kind_of(std::span<const std::byte> message) {
  if (message.empty()) throw BadMessage("it is empty");
  const auto kind = std::to_integer<std::uint8_t>(message[0]);
  if (kind > static_cast<std::uint8_t>(RecordKind::account)) {
    throw BadMessage(fmt::format("it has kind {}: it was made by a newer version", kind));
  }
  return checked(kind, RecordKind::options, RecordKind::account, "kind");
}

Waypoint values_of(const ipc::RingItem& item) noexcept {
  Waypoint waypoint = item.waypoint();
  if (!has_position(item)) waypoint.position = {};
  return waypoint;
}

Condition condition_of(const ipc::RingItem& item) {
  const Waypoint values = item.waypoint();
  const auto value =
      item.condition == ConditionKind::velocity ? values.velocity : values.acceleration;
  return {.kind = item.condition, .value = {value.begin(), value.end()}};
}

Bytes encode(const NumberedItem& numbered) {
  const ipc::RingItem& item = numbered.item;
  Bytes bytes = begin(RecordKind::item, 36 + item.values.size() * sizeof(double));
  const Waypoint values = values_of(item);
  const auto flags = static_cast<std::uint8_t>(
      (values.velocity.empty() ? 0 : kHasVelocity) |
      (values.acceleration.empty() ? 0 : kHasAcceleration) | (numbered.is_old ? kIsOld : 0));
  ByteWriter(bytes)
      .put(numbered.number)
      .put(static_cast<std::uint8_t>(item.kind))
      .put(flags)
      .put(item.kind == ipc::ItemKind::rate ? item.commander
                                            : static_cast<std::uint8_t>(item.condition))
      .put(item.place)
      .put(item.count)
      .put(item.time)
      .put(item.blend)
      .put(values.position)
      .put(values.velocity)
      .put(values.acceleration);
  return bytes;
}

NumberedItem decode_item(std::span<const std::byte> bytes, std::size_t dimensions) {
  ByteReader in(bytes);
  NumberedItem found{.number = in.take<ipc::Word>(), .item = ipc::RingItem(dimensions)};
  ipc::RingItem& item = found.item;
  item.kind =
      checked(in.take<std::uint8_t>(), ipc::ItemKind::waypoint, ipc::ItemKind::rate, "item kind");
  const auto flags = in.take<std::uint8_t>();
  found.is_old = (flags & kIsOld) != 0;
  item.has_velocity = (flags & kHasVelocity) != 0;
  item.has_acceleration = (flags & kHasAcceleration) != 0;
  if (item.kind == ipc::ItemKind::rate) {
    item.commander = in.take<std::uint8_t>();
  } else {
    item.condition =
        checked(in.take<std::uint8_t>(), ConditionKind::natural, ConditionKind::own, "condition");
  }
  item.place = in.take<std::uint8_t>();
  item.count = in.take<std::uint32_t>();
  item.time = in.take_time();
  item.blend = in.take_time();
  const auto place = [&](bool is_given, std::size_t part) {
    if (!is_given) return;
    const auto values = in.take_doubles(dimensions);
    std::ranges::copy(values, std::span(item.values).subspan(part * dimensions).begin());
  };
  place(has_position(item), 0);
  place(item.has_velocity, 1);
  place(item.has_acceleration, 2);
  in.require_end();
  return found;
}

Bytes encode(const ipc::RefusalRecord& refused) {
  Bytes bytes = begin(RecordKind::refusal, 9);
  ByteWriter(bytes).put(refused.item).put(static_cast<std::uint8_t>(refused.reason));
  return bytes;
}

ipc::RefusalRecord decode_refusal(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  ipc::RefusalRecord refused{.item = in.take<ipc::Word>()};
  refused.reason = checked(in.take<std::uint8_t>(), Refusal::past,
                           static_cast<Refusal>(kRefusals - 1), "reason");
  in.require_end();
  return refused;
}

}  // namespace splinecast::apps::record
