#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "apps/messages/bytes.hpp"
#include "apps/messages/json_fields.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "splinecast/waypoint.hpp"

/// The waypoints of a stream that this program recorded: `/NAME/waypoints`. A replacement replaces
/// the future: the rows before it whose time is not before its own are left out.
namespace splinecast::apps {
namespace {

constexpr std::string_view kKind = R"("kind":")";
constexpr std::string_view kWaypoints = "/waypoints";
constexpr std::string_view kReplacement = "replace";

/// The names of the dimensions, in the order of the schema. Throws MessageError if it has none.
std::vector<std::string> dimensions_of(std::string_view schema) {
  std::vector<std::string> names;
  const auto json = nlohmann::ordered_json::parse(schema, nullptr, false);
  const nlohmann::ordered_json::json_pointer place("/properties/position/properties");
  if (!json.is_discarded() && json.contains(place) && json[place].is_object()) {
    for (const auto& [name, type] : json[place].items()) names.push_back(name);
  }
  if (names.empty() || names.size() > kMaxDimensions) {
    throw MessageError(fmt::format("its schema has {} dimensions instead of 1 to {}", names.size(),
                                   kMaxDimensions));
  }
  return names;
}

/// The dimensions of the stream in the file's metadata: a list of objects with `unit`, `kind` and
/// `period`. Null if the file has none for this number of dimensions.
nlohmann::json described(const TopicBeginning& topic, std::size_t dimensions) {
  std::string_view stream = topic.name;
  if (!stream.starts_with('/') || !stream.ends_with(kWaypoints)) return nullptr;
  stream = stream.substr(1, stream.size() - 1 - kWaypoints.size());
  const auto found = std::ranges::find(topic.metadata, fmt::format("splinecast:{}", stream),
                                       &mcap::Metadata::name);
  if (found == topic.metadata.end() || !found->values.contains("dimensions")) return nullptr;
  auto list = nlohmann::json::parse(found->values.at("dimensions"), nullptr, false);
  const bool fits = list.is_array() && list.size() == dimensions &&
                    std::ranges::all_of(list, [](const auto& each) { return each.is_object(); });
  return fits ? list : nullptr;
}

/// A member of an object; `other` if it is missing or of another type.
template <typename T>
T member(const nlohmann::json& object, const char* name, T other) {
  const auto found = object.find(name);
  if (found == object.end()) return other;
  if constexpr (std::is_same_v<T, double>) {
    return found->is_number() ? found->template get<T>() : other;
  } else {
    return found->is_string() ? found->template get<T>() : other;
  }
}

/// The kind of a described dimension; linear if it is not valid.
Dimension kind_of(const nlohmann::json& dimension) {
  auto text = member(dimension, "kind", std::string("linear"));
  if (text == "periodic") text += fmt::format(":{}", member(dimension, "period", 0.0));
  return parse_dimension(text).value_or(Dimension{});
}

/// The dimensions that are read from each message.
struct Chosen {
  std::vector<std::string> names;  ///< in the messages
  RowColumns columns;
};

Chosen chosen_of(const TopicBeginning& topic, const TableOptions& options) {
  const std::vector<std::string> dimensions = dimensions_of(topic.schema);
  const nlohmann::json described_as = described(topic, dimensions.size());
  Chosen chosen{.names = chosen_names(options), .columns = {}};
  if (chosen.names.empty()) chosen.names = dimensions;
  for (const std::string& name : chosen.names) {
    const auto found = std::ranges::find(dimensions, name);
    if (found == dimensions.end()) {
      throw InputError(fmt::format("there is no dimension '{}'", shown(name)));
    }
    chosen.columns.names.push_back(name);
    if (described_as.is_null()) continue;
    const auto& dimension = described_as[static_cast<std::size_t>(found - dimensions.begin())];
    const auto unit = member(dimension, "unit", std::string());
    if (!unit.empty()) chosen.columns.names.back() += fmt::format(" [{}]", unit);
    chosen.columns.kinds.push_back(kind_of(dimension));
  }
  return chosen;
}

/// The fields of a message: kind, time, then the dimensions of position, velocity, acceleration.
std::vector<JsonPath> paths_of(const std::vector<std::string>& names) {
  std::vector<JsonPath> paths{{"kind"}, {"time_ns"}};
  for (const char* part : {"position", "velocity", "acceleration"}) {
    for (const std::string& name : names) paths.push_back({part, name});
  }
  return paths;
}

class RecordingRows final : public MessageDecoder {
 public:
  RecordingRows(Chosen chosen, WhichTime which)
      : which_(which), columns_(std::move(chosen.columns)), fields_(paths_of(chosen.names)) {
    values_.resize(3 * columns_.names.size());
  }

  [[nodiscard]] const RowColumns& columns() const override { return columns_; }
  [[nodiscard]] std::string time_name() const override { return name_of_time(which_, "time_ns"); }

  void take(const TopicMessage& message) override {
    has_row_ = false;
    fields_.read(text_of(message.data));
    const std::string_view kind = fields_.text(0);
    if (kind != R"("waypoint")" && kind != R"("start_state")") return;
    row_ = {.number = message.number,
            .time = time_of(message, stamp(), which_),
            .position = values(0, true),
            .velocity = values(1, false),
            .acceleration = values(2, false)};
    has_row_ = !is_replaced(row_);
  }
  bool next(Row& row) override {
    if (!has_row_) return false;
    row = row_;
    has_row_ = false;
    return true;
  }
  void rewind() override {
    has_row_ = false;
    next_replacement_ = 0;
    // A later replacement may reach back further: it also replaces what the ones before it do.
    Time from = Time::max();
    for (auto each = replacements_.rbegin(); each != replacements_.rend(); ++each) {
      from = each->from = std::min(each->from, from);
    }
  }

  [[nodiscard]] bool wants_survey() const override { return true; }
  void survey(const TopicMessage& message) override {
    // The kind is the second field that the recorder writes.
    const std::string_view text = text_of(message.data);
    const std::size_t at = text.find(kKind);
    if (at == std::string_view::npos || !text.substr(at + kKind.size()).starts_with(kReplacement)) {
      return;
    }
    try {
      fields_.read(text);
      const Time time = time_of(message, stamp(), which_);
      replacements_.push_back({.number = message.number, .from = time});
    } catch (const MessageError&) {  // take() reports it
      return;
    }
  }

 private:
  struct Replacement {
    std::uint64_t number = 0;  ///< of the message
    Time from{};  ///< the time that it replaces from; after rewind(), the earliest one of
                  ///< it and those after it
  };

  [[nodiscard]] Time stamp() const {
    const auto time = parse_time(fields_.text(1), TimeUnit::nanoseconds);
    if (!time) throw MessageError("field 'time_ns' is missing or not a time");
    return *time;
  }

  /// The values of a part, 0 to 2; empty if the message does not have it.
  [[nodiscard]] std::span<const double> values(std::size_t part, bool is_needed) {
    const std::size_t dimensions = columns_.names.size();
    const std::size_t first = 2 + part * dimensions;
    if (!is_needed && fields_.text(first).empty()) return {};
    const auto values = std::span(values_).subspan(part * dimensions, dimensions);
    for (std::size_t d = 0; d < dimensions; ++d) values[d] = fields_.number(first + d);
    return values;
  }

  [[nodiscard]] bool is_replaced(const Row& row) {
    while (next_replacement_ < replacements_.size() &&
           replacements_[next_replacement_].number <= row.number) {
      ++next_replacement_;
    }
    return next_replacement_ < replacements_.size() &&
           row.time >= replacements_[next_replacement_].from;
  }

  WhichTime which_;
  RowColumns columns_;
  JsonFields fields_;
  std::vector<double> values_;
  std::vector<Replacement> replacements_;  ///< in the order of the file; `from` never decreases
  std::size_t next_replacement_ = 0;       ///< the first one after the last row
  Row row_;
  bool has_row_ = false;
};

}  // namespace

std::unique_ptr<MessageDecoder> open_recorded_stream(const TopicBeginning& topic,
                                                     const TableOptions& options) {
  return std::make_unique<RecordingRows>(chosen_of(topic, options), options.which_time);
}

}  // namespace splinecast::apps
