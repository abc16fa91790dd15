#include "ipc/options/stream.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/common_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/options.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/process_life.hpp"
#include "ipc/memory/separation.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

/// The longest prefix of at most `most` bytes that does not split a UTF-8 character.
std::string cut(const std::string& text, std::size_t most) {
  std::size_t length = std::min(text.size(), most);
  // The byte after the prefix must not be a UTF-8 continuation byte.
  while (length > 0 && length < text.size() &&
         (static_cast<unsigned char>(text[length]) & 0xc0U) == 0x80U) {
    --length;
  }
  return text.substr(0, length);
}

template <std::size_t N>
void put_texts(const std::vector<std::string>& texts, std::size_t dimensions, const char* what,
               std::array<std::array<char, N>, kMaxDimensions>& out) {
  if (!texts.empty() && texts.size() != dimensions) {
    throw BadRequest(std::to_string(texts.size()) + ' ' + what + " for " +
                     std::to_string(dimensions) + " dimensions");
  }
  for (std::size_t d = 0; d < texts.size(); ++d) {
    std::ranges::copy(cut(texts[d], N - 1), out[d].begin());
  }
}

template <std::size_t N>
std::vector<std::string> texts_of(const std::array<std::array<char, N>, kMaxDimensions>& texts,
                                  std::size_t dimensions) {
  std::vector<std::string> out;
  for (std::size_t d = 0; d < dimensions; ++d) out.push_back(text_of(texts[d]));
  return out;
}

void put_kinds(const ProducerOptions& options, RegionHeader& header) {
  const std::vector<Dimension>& kinds = options.kinds;
  if (!kinds.empty() && kinds.size() != options.dimensions) {
    throw BadRequest(std::to_string(kinds.size()) + " kinds for " +
                     std::to_string(options.dimensions) + " dimensions");
  }
  try {
    (void)DimensionKinds(kinds);
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
  for (std::size_t d = 0; d < kinds.size(); ++d) {
    header.dimension_kind[d] = static_cast<std::uint64_t>(kinds[d].kind);
    header.period[d] = kinds[d].period;
  }
}

/// Throws BadRequest for a value out of its option's range.
void require_ranges(ProducerOptions options) {
  for_each_stream_option([&](const auto& row) {
    const auto value = row.kOption(options);
    if (is_in_range(row, value)) return;
    throw BadRequest(out_of_range(row, value));
  });
  if (options.limits.max_interval >= options.limits.min_interval) return;
  throw BadRequest("longest interval must be min_interval, " +
                   value_text(options.limits.min_interval) + ", or more, not " +
                   value_text(options.limits.max_interval));
}

}  // namespace

void require_usable(const std::string& which, const Condition& condition, std::size_t dimensions) {
  try {
    require_values(condition, dimensions);
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
  if (!is_online(condition.kind)) {
    throw BadRequest(which + " condition '" + to_string(condition) +
                     "' needs all waypoints at once: a stream cannot meet it");
  }
}

RegionHeader blank_header(std::uint64_t id, bool is_live) noexcept {
  RegionHeader header{};
  header.magic = kMagic;
  header.mark = {};
  header.layout_hash = layout_hash();
  header.stream_id = id;
  header.time_namespace = is_live ? time_namespace() : 0;
  header.control = kHeaderBytes + id % kControlPositions * kSeparation;
  return header;
}

RegionHeader make_header(const ProducerOptions& options, std::uint64_t stream_id) {
  if (options.dimensions < kMinDimensions || options.dimensions > kMaxDimensions) {
    throw BadRequest("a stream has 1 to 64 dimensions, not " + std::to_string(options.dimensions));
  }
  require_ranges(options);
  require_usable("start", options.start, options.dimensions);
  if ((options.clock == StreamClock::law) == options.law.empty()) {
    throw BadRequest(options.law.empty() ? "a stream with clock law needs the name of a law"
                                         : "a stream that follows a law has clock law");
  }
  RegionHeader header = blank_header(stream_id, is_live(options.clock));
  header.dimensions = options.dimensions;
  header.clock = static_cast<std::uint64_t>(options.clock);
  ProducerOptions values = options;
  for_each_stream_option([&](const auto& row) {
    if constexpr (std::remove_cvref_t<decltype(row)>::kHasField) {
      put_value(row, row.kOption(values), header);
    }
  });
  header.start_kind = static_cast<std::uint64_t>(options.start.kind);
  std::ranges::copy(options.start.value, header.start_value.begin());
  std::ranges::copy(options.law.substr(0, kLawNameBytes - 1), header.law.begin());
  put_kinds(options, header);
  put_texts(options.names, options.dimensions, "names", header.name);
  put_texts(options.units, options.dimensions, "units", header.unit);
  return header;
}

Condition start_condition(const RegionHeader& header) {
  Condition start{.kind = static_cast<ConditionKind>(header.start_kind), .value = {}};
  if (start.kind == ConditionKind::velocity || start.kind == ConditionKind::acceleration) {
    const auto values = std::span(header.start_value).first(header.dimensions);
    start.value.assign(values.begin(), values.end());
  }
  return start;
}

std::vector<std::string> dimension_names(const RegionHeader& header) {
  return texts_of(header.name, header.dimensions);
}

std::vector<std::string> dimension_units(const RegionHeader& header) {
  return texts_of(header.unit, header.dimensions);
}

DimensionKinds dimension_kinds(const RegionHeader& header) {
  return DimensionKinds(dimensions_of(header));
}

IntervalRange interval_range(const RegionHeader& header) noexcept {
  return {.least = Time(header.min_interval), .most = Time(header.max_interval)};
}

StreamClock stream_clock(const RegionHeader& header) noexcept {
  return static_cast<StreamClock>(header.clock);
}

std::string header_name(const std::string& name) { return cut(name, kNameBytes - 1); }

void require_same_stream(const RegionHeader& ring, const RegionHeader& board) {
  const auto require = [](bool is_same, const char* what) {
    if (!is_same) throw BadRegion(std::string("the regions of the stream differ in ") + what);
  };
  require(ring.stream_id == board.stream_id, "their stream id");
  require(ring.dimensions == board.dimensions, "the number of dimensions");
  require(dimensions_of(ring) == dimensions_of(board), "dimension kinds");
  require(ring.clock == board.clock && ring.time_namespace == board.time_namespace, "their clock");
  require(ring.is_law == board.is_law && ring.law_origin == board.law_origin &&
              ring.law_id == board.law_id && ring.law == board.law,
          "their time law");
  require(start_condition(ring) == start_condition(board), "the start condition");
}

void require_same_options(const std::string& stream, const RegionHeader& existing,
                          const ProducerOptions& options) {
  const auto contradict = [&](const std::string& what) {
    throw BadRequest("stream '" + stream + "' was left unfinished by its producer and has " + what +
                     "; 'splinecast rm " + stream +
                     "' removes it, once its solver has been stopped");
  };
  const RegionHeader wanted = make_header(options, existing.stream_id);
  if (wanted.dimensions != existing.dimensions) {
    contradict(std::to_string(existing.dimensions) + " dimensions, not " +
               std::to_string(wanted.dimensions));
  }
  if (wanted.clock != existing.clock) contradict("another clock");
  if (wanted.law != existing.law) contradict("time law '" + text_of(existing.law) + "'");
  if (start_condition(wanted) != start_condition(existing)) {
    contradict("start condition " + to_string(start_condition(existing)) + ", not " +
               to_string(options.start));
  }
  if (dimensions_of(wanted) != dimensions_of(existing)) contradict("other dimension kinds");
  if (wanted.name != existing.name) contradict("other dimension names");
  if (wanted.unit != existing.unit) contradict("other units");
  for_each_stream_option([&](const auto& row) {
    if constexpr (std::remove_cvref_t<decltype(row)>::kHasField) {
      if (value_in(row, wanted) == value_in(row, existing) || row.key == "capacity") return;
      contradict(std::string(row.name) + ' ' + value_text(value_in(row, existing)) + ", not " +
                 value_text(value_in(row, wanted)));
    }
  });
}

}  // namespace splinecast::ipc
