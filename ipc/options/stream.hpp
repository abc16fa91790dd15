#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ipc/layout/header.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/options.hpp"

/// The options of a stream, which its producer sets: functions that write them to a header, read
/// them from one, and compare them.
namespace splinecast::ipc {

/// A header for a new region, except the fields that depend on its kind and capacity.
[[nodiscard]] RegionHeader make_header(const ProducerOptions& options, std::uint64_t stream_id);

/// The fields of a header for a new region that do not depend on the stream; `is_live`: its times
/// are those of this process's clock.
[[nodiscard]] RegionHeader blank_header(std::uint64_t id, bool is_live) noexcept;

/// Throws BadRequest, which calls the condition `which`, unless its values fit the dimensions and
/// it is an online condition.
void require_usable(const std::string& which, const Condition& condition, std::size_t dimensions);

/// The stream's options in a header, as its producer set them.
[[nodiscard]] Condition start_condition(const RegionHeader& header);

[[nodiscard]] std::vector<std::string> dimension_names(const RegionHeader& header);

[[nodiscard]] std::vector<std::string> dimension_units(const RegionHeader& header);

[[nodiscard]] DimensionKinds dimension_kinds(const RegionHeader& header);

[[nodiscard]] IntervalRange interval_range(const RegionHeader& header) noexcept;

[[nodiscard]] StreamClock stream_clock(const RegionHeader& header) noexcept;

/// A dimension's name as a header stores it: truncated to at most kNameBytes − 1 bytes, without
/// splitting a UTF-8 character.
[[nodiscard]] std::string header_name(const std::string& name);

/// Throws BadRegion, naming what differs, unless the ring's and the board's header agree on the
/// stream id, the dimensions, their kinds, the clock and the start condition.
void require_same_stream(const RegionHeader& ring, const RegionHeader& board);

/// Throws BadRequest, naming what differs, if a producer's options contradict the header of the
/// stream that it is to continue.
void require_same_options(const std::string& stream, const RegionHeader& existing,
                          const ProducerOptions& options);

}  // namespace splinecast::ipc
