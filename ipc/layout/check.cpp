#include "ipc/layout/check.hpp"

#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/options.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/memory/separation.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/method.hpp"

namespace splinecast::ipc {
namespace {

/// kByteOrder as a machine with the other byte order writes it.
constexpr std::uint32_t kOtherByteOrder = 0x04030201;

void require(bool holds, const char* what, std::uint64_t found, std::uint64_t wanted) {
  if (holds) return;
  throw BadRegion("region has " + std::string(what) + ' ' + std::to_string(found) + ", not " +
                  std::to_string(wanted));
}

void require_range(const char* what, std::uint64_t found, std::uint64_t least, std::uint64_t most) {
  if (found >= least && found <= most) return;
  throw BadRegion("region has " + std::string(what) + ' ' + std::to_string(found) +
                  ", not between " + std::to_string(least) + " and " + std::to_string(most));
}

void require_dimension_kinds(const RegionHeader& header) {
  for (std::size_t d = 0; d < header.dimensions; ++d) {
    require_range("kind of dimension", header.dimension_kind[d], 0, kDimensionKinds - 1);
  }
  try {
    (void)DimensionKinds(dimensions_of(header));
  } catch (const std::invalid_argument& error) {
    throw BadRegion(std::string("region has invalid dimensions: ") + error.what());
  }
}

/// Throws BadRegion for a region of another version or build of splinecast. The message names both
/// layouts and the remedy.
void require_this_layout(const RegionHeader& header) {
  const std::uint32_t version = header.mark.version;
  if (version != kLayoutVersion) {
    throw BadRegion("region has layout version " + std::to_string(version) +
                    ", this splinecast has version " + std::to_string(kLayoutVersion) +
                    "; use one splinecast for all processes of the stream, or stop those of the "
                    "other version and remove its regions with `splinecast rm`");
  }
  if (header.layout_hash == layout_hash()) return;
  throw BadRegion("region has layout version " + std::to_string(version) + " with hash " +
                  std::to_string(header.layout_hash) + ", this splinecast has version " +
                  std::to_string(kLayoutVersion) + " with hash " + std::to_string(layout_hash()) +
                  "; use one build for all processes of the stream, or stop those of the other one "
                  "and remove its regions with `splinecast rm`");
}

/// Checks the name of the law that a stream follows.
void require_law(const RegionHeader& header) {
  require_range("time law", header.is_law, 0, 1);
  const bool has_rate = header.is_law != 0 || header.law_id != 0;
  if (has_rate && !(max_rate(header) > 0 && max_rate(header) <= kLargestRate)) {
    throw BadRegion("region has largest rate " + std::to_string(max_rate(header)));
  }
  const bool follows = header.clock == static_cast<std::uint64_t>(StreamClock::law);
  if (follows == (header.law_id != 0) && follows == is_stream_name(text_of(header.law))) return;
  throw BadRegion("region has clock " + std::to_string(header.clock) + ", but a law named '" +
                  printable(text_of(header.law)) + "' with id " + std::to_string(header.law_id));
}

/// Checks the values that every region has.
void require_region(const RegionHeader& header, RegionKind kind, std::size_t real_bytes) {
  const std::uint32_t order = header.mark.byte_order;
  require(order != kOtherByteOrder, "byte order", order, kByteOrder);
  require(header.magic == kMagic, "magic number", header.magic, kMagic);
  require(order == kByteOrder, "byte order", order, kByteOrder);
  require_this_layout(header);
  require(header.kind == static_cast<std::uint64_t>(kind), "kind", header.kind,
          static_cast<std::uint64_t>(kind));
  require_range("control offset", header.control, kHeaderBytes,
                kHeaderBytes + (kControlPositions - 1) * kSeparation);
  require(header.control % kSeparation == 0, "control offset", header.control,
          round_up(header.control, kSeparation));
  require_range("clock", header.clock, 0, static_cast<std::uint64_t>(StreamClock::law));
  require(header.region_bytes == real_bytes, "size", real_bytes, header.region_bytes);
}

/// Checks the word of a header that has this option.
template <typename Row>
void require_in_range(const Row& row, const RegionHeader& header) {
  const auto found = header.*Row::kField;
  const auto word = [](auto value) {
    if constexpr (std::is_same_v<decltype(value), Time>)
      return value.count();
    else
      return static_cast<std::remove_cvref_t<decltype(found)>>(value);
  };
  if (!has_option(row, header) ||
      (found >= word(row.range.least) && found <= word(row.range.most))) {
    return;
  }
  throw BadRegion("region has " + std::string(row.name) + ' ' + value_text(found) + ", not " +
                  std::string(row.range.text));
}

/// Checks the values that both regions of a stream have.
void require_stream(const RegionHeader& header, std::size_t max_capacity) {
  require_range("dimensions", header.dimensions, kMinDimensions, kMaxDimensions);
  require_dimension_kinds(header);
  require_range("capacity", header.capacity, 2, max_capacity);
  require(std::has_single_bit(header.capacity), "capacity", header.capacity,
          std::bit_ceil(header.capacity));
  require_law(header);
  require_range("start condition", header.start_kind, 0,
                static_cast<std::uint64_t>(ConditionKind::own));
  if (!is_online(static_cast<ConditionKind>(header.start_kind))) {
    throw BadRegion("region has start condition " + std::to_string(header.start_kind) +
                    ", which a stream cannot meet");
  }
  for (std::size_t d = 0; d < header.dimensions; ++d) {
    if (is_usable(header.start_value[d])) continue;
    throw BadRegion("region has start value " + std::to_string(header.start_value[d]));
  }
  require_in_range(stream_option<&min_interval_of>(), header);
  require_in_range(stream_option<&max_interval_of>(), header);
}

/// Checks the values that define the curve. SlidingWindow refuses invalid ones too, but does not
/// throw BadRegion.
void require_curve(const RegionHeader& header) {
  const Method* const method = find_method(header.method);
  if (method == nullptr || !method->streams()) {
    throw BadRegion("region has method " + std::to_string(header.method) +
                    ", which is not an online method");
  }
  for_each_option([&](const auto& row) { require_in_range(row, header); });
  if (!method->converges()) {
    require_range("settle lag", header.settle, method->look_ahead, core::kMaxSettle);
  }
  require_range("rules", header.rules, kFormerRules, kRules);
}

void require_motion_limits(const RegionHeader& header) {
  try {
    require_limits(motion_limits(header), dimensions_of(header));
  } catch (const std::invalid_argument& error) {
    throw BadRegion(std::string("region has bad limits: ") + error.what());
  }
}

}  // namespace

RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes) {
  require_region(header, RegionKind::waypoints, real_bytes);
  require_stream(header, kMaxRingCapacity);
  const auto layout = RingLayout::of(header.dimensions, header.capacity, header.control);
  require(header.stride == layout.stride, "item size", header.stride, layout.stride);
  require(real_bytes == layout.bytes, "size", real_bytes, layout.bytes);
  return layout;
}

BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes) {
  require_region(header, RegionKind::spline, real_bytes);
  require_stream(header, kMaxBoardCapacity);
  require_curve(header);
  const auto layout = BoardLayout::of(header.dimensions, header.capacity, header.control,
                                      smooths(header), header.is_law != 0);
  require_motion_limits(header);
  require(header.stride == layout.stride, "slot size", header.stride, layout.stride);
  require(real_bytes == layout.bytes, "size", real_bytes, layout.bytes);
  return layout;
}

RequestLayout checked_request_layout(const RegionHeader& header, RegionKind kind,
                                     std::size_t real_bytes) {
  require_region(header, kind, real_bytes);
  const RequestLayout layout{.control = header.control};
  require(real_bytes == layout.bytes, "size", real_bytes, layout.bytes);
  return layout;
}

}  // namespace splinecast::ipc
