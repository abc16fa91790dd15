#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/record/format/messages.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Writes the messages of a stream's JSON channels. Every number reads back exactly. One thread
/// uses it.
class JsonMessages {
 public:
  /// For the stream of this header.
  explicit JsonMessages(const ipc::RegionHeader& header);

  /// An item, as `/NAME/waypoints` has it. A view, valid until the next call.
  [[nodiscard]] std::string_view waypoint(const NumberedItem& numbered);

  /// A sample of a segment of this kind, as `/NAME/states` has it. A view, valid until the next
  /// call.
  [[nodiscard]] std::string_view state(Time time, SegmentKind kind, const State& state);

  /// JSON Schemas of the channels.
  [[nodiscard]] std::string waypoint_schema() const;
  [[nodiscard]] std::string state_schema() const;
  [[nodiscard]] static std::string event_schema();

 private:
  void values(std::string_view name, std::span<const double> values);
  [[nodiscard]] std::string schema(std::string_view title, std::string_view further) const;

  std::vector<std::string> keys_;  ///< `"name":` of each dimension, quoted and escaped
  std::vector<std::string> units_;
  std::string text_;
};

/// A text as JSON, in quotes. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(std::string_view text);

/// Appends a number that reads back as the same bits.
void append_number(std::string& text, double value);

}  // namespace splinecast::apps::record
