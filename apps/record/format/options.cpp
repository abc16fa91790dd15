#include "apps/record/format/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

#include "apps/output/options.hpp"
#include "apps/record/format/bytes.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/method.hpp"

namespace splinecast::apps::record {
namespace {

using ipc::RegionHeader;
using nlohmann::json;
using nlohmann::ordered_json;

/// By StreamClock.
constexpr std::array<std::string_view, 3> kClocks{"recorded", "live", "law"};

/// A limit or a bound; null: none.
ordered_json limit_to_json(double value) {
  return value == 0 || !std::isfinite(value) ? ordered_json() : ordered_json(value);
}
ordered_json bound_to_json(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json dimensions_to_json(const StreamOptions& options) {
  const std::vector<Dimension> kinds = ipc::dimensions_of(options.waypoints);
  ordered_json all = ordered_json::array();
  for (std::size_t d = 0; d < options.waypoints.dimensions; ++d) {
    all.push_back({{"name", ipc::text_of(options.waypoints.name[d])},
                   {"unit", ipc::text_of(options.waypoints.unit[d])},
                   {"kind", to_string(Dimension{.kind = kinds[d].kind, .period = 1})},
                   {"period", kinds[d].period}});
    if (kinds[d].kind == DimensionKind::periodic) all.back()["kind"] = "periodic";
    if (!options.spline) continue;
    const RegionHeader& spline = *options.spline;
    const bool has_bounds = spline.lower_bound[d] != 0 || spline.upper_bound[d] != 0;
    all.back()["max_velocity"] = limit_to_json(spline.max_velocity[d]);
    all.back()["max_acceleration"] = limit_to_json(spline.max_acceleration[d]);
    all.back()["max_jerk"] = limit_to_json(spline.max_jerk[d]);
    all.back()["has_bounds"] = has_bounds;
    all.back()["lower"] = bound_to_json(spline.lower_bound[d]);
    all.back()["upper"] = bound_to_json(spline.upper_bound[d]);
  }
  return all;
}

ordered_json solver_to_json(const RegionHeader& header) {
  ordered_json fields{{"method", find_method(header.method)->name}};
  fields.update(curve_to_json(header));
  fields["rules"] = header.rules;
  fields["epoch"] = header.epoch;
  fields["pid"] = header.owner_pid;
  return fields;
}

/// Takes fields of a JSON object. Throws BadMessage, naming the field.
class Fields {
 public:
  explicit Fields(const json& object) : object_(object) {
    if (!object.is_object()) throw BadMessage("it is not a JSON object");
  }
  template <typename T>
  [[nodiscard]] T take(const char* name) const {
    try {
      return at(name).get<T>();
    } catch (const json::exception&) {
      throw BadMessage(fmt::format("its field '{}' has another type", name));
    }
  }
  /// A number; `none` for null.
  [[nodiscard]] double number_or(const char* name, double none) const {
    return at(name).is_null() ? none : take<double>(name);
  }
  [[nodiscard]] const json& at(const char* name) const {
    const auto found = object_.find(name);
    if (found == object_.end()) throw BadMessage(fmt::format("it has no field '{}'", name));
    return *found;
  }
  [[nodiscard]] bool has(const char* name) const { return object_.contains(name); }
  [[nodiscard]] BadMessage bad(const char* name) const {
    return BadMessage(fmt::format("its field '{}' is {}", name,
                                  ipc::printable(at(name).dump(-1, ' ', true).substr(0, 100))));
  }

 private:
  const json& object_;
};

DimensionKind kind_named(const Fields& fields) {
  const auto name = fields.take<std::string>("kind");
  if (name == "periodic") return DimensionKind::periodic;
  const auto found = parse_dimension(name);
  if (!found) throw fields.bad("kind");
  return found->kind;
}

template <std::size_t N>
void put_text(const std::string& text, std::array<char, N>& out) {
  std::ranges::copy(text.substr(0, N - 1), out.begin());
}

void put_dimension(const Fields& fields, bool has_curve, std::size_t d, RegionHeader& header) {
  put_text(fields.take<std::string>("name"), header.name[d]);
  put_text(fields.take<std::string>("unit"), header.unit[d]);
  header.dimension_kind[d] = static_cast<std::uint64_t>(kind_named(fields));
  header.period[d] = fields.take<double>("period");
  if (!has_curve) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  header.max_velocity[d] = fields.number_or("max_velocity", 0);
  header.max_acceleration[d] = fields.number_or("max_acceleration", 0);
  header.max_jerk[d] = fields.number_or("max_jerk", 0);
  if (!fields.take<bool>("has_bounds")) return;
  header.lower_bound[d] = fields.number_or("lower", -kInfinity);
  header.upper_bound[d] = fields.number_or("upper", kInfinity);
}

/// The value of an option of a curve; its range is checked with the header.
template <typename Row>
typename Row::Value take_value(const Row& row, const Fields& fields) {
  using Value = typename Row::Value;
  const std::string key = json_key(row);
  if constexpr (std::is_same_v<Value, Time>) {
    return Time(fields.take<std::int64_t>(key.c_str()));
  } else if constexpr (std::is_enum_v<Value>) {
    const auto found = ipc::value_of_word<Value>(fields.take<std::string>(key.c_str()));
    if (!found) throw fields.bad(key.c_str());
    return *found;
  } else {
    return fields.take<Value>(key.c_str());
  }
}

/// What the stream is to time laws: it follows one, or it is one.
void parse_law(const Fields& fields, RegionHeader& header) {
  if (header.clock == static_cast<std::uint64_t>(StreamClock::law)) {
    const Fields law(fields.at("law"));
    const auto name = law.take<std::string>("name");
    if (name.size() >= header.law.size()) throw law.bad("name");
    std::ranges::copy(name, header.law.begin());
    header.law_id = law.take<std::uint64_t>("id");
    header.largest_rate = law.has("largest_rate") ? law.take<double>("largest_rate") : 1;
  }
  if (!fields.has("time_law")) return;
  const Fields law(fields.at("time_law"));
  header.is_law = 1;
  header.law_origin = law.take<std::int64_t>("origin_ns");
  header.largest_rate = law.take<double>("largest_rate");
}

RegionHeader parse_common(const Fields& fields, bool has_curve) {
  RegionHeader header;
  header.magic = ipc::kMagic;
  header.layout_hash = ipc::layout_hash();
  header.control = ipc::kHeaderBytes;
  header.stream_id = fields.take<std::uint64_t>("stream_id");
  const json& dimensions = fields.at("dimensions");
  if (!dimensions.is_array() || dimensions.size() > kMaxDimensions) throw fields.bad("dimensions");
  header.dimensions = dimensions.size();
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    put_dimension(Fields(dimensions[d]), has_curve, d, header);
  }
  const auto clock = fields.take<std::string>("clock");
  const auto* const known = std::ranges::find(kClocks, clock);
  if (known == kClocks.end()) throw fields.bad("clock");
  header.clock = static_cast<std::uint64_t>(known - kClocks.begin());
  parse_law(fields, header);
  const auto start = fields.take<std::string>("start");
  const auto condition = start == to_string(Condition{.kind = ConditionKind::own, .value = {}})
                             ? Condition{.kind = ConditionKind::own, .value = {}}
                             : parse_condition(start).value_or(
                                   Condition{.kind = ConditionKind::periodic, .value = {}});
  if (condition.value.size() > header.dimensions) throw fields.bad("start");
  header.start_kind = static_cast<std::uint64_t>(condition.kind);
  std::ranges::copy(condition.value, header.start_value.begin());
  for_each_interval([&](const auto& row) { ipc::put_value(row, take_value(row, fields), header); });
  return header;
}

void parse_solver(const Fields& fields, RegionHeader& header) {
  const Method* const method = find_method(fields.take<std::string>("method"));
  if (method == nullptr) throw fields.bad("method");
  header.kind = static_cast<std::uint64_t>(ipc::RegionKind::spline);
  header.method = method->number;
  for_each_field([&](const auto& row) { ipc::put_value(row, take_value(row, fields), header); });
  header.rules = fields.has("rules") ? fields.take<std::uint64_t>("rules") : ipc::kFormerRules;
  header.epoch = fields.take<std::uint64_t>("epoch");
  header.owner_pid = fields.take<std::uint64_t>("pid");
}

/// Completes a header as a region of this program has it, and checks it like that of a region.
void check_ring(RegionHeader& header) {
  header.kind = static_cast<std::uint64_t>(ipc::RegionKind::waypoints);
  const auto layout = ipc::RingLayout::of(
      header.dimensions, std::min(header.capacity, ipc::kMaxRingCapacity), header.control);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  (void)ipc::checked_ring_layout(header, layout.bytes);
}
void check_board(RegionHeader& header) {
  const auto layout =
      ipc::BoardLayout::of(header.dimensions, std::min(header.capacity, ipc::kMaxBoardCapacity),
                           header.control, ipc::smooths(header), header.is_law != 0);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  (void)ipc::checked_board_layout(header, layout.bytes);
}

StreamOptions parse(const json& object) {
  const Fields fields(object);
  const auto format = fields.take<int>("format");
  if (format > kFormat) {
    throw BadMessage(fmt::format(
        "it was made by a newer version: it has format {}, this program reads formats 1 to {}",
        format, kFormat));
  }
  if (format < 1) throw BadMessage(fmt::format("it has format {}, not 1 to {}", format, kFormat));
  StreamOptions options{.format = format, .stream = fields.take<std::string>("stream")};
  ipc::require_stream_name(options.stream);
  options.wall_offset = Time(fields.take<std::int64_t>("wall_offset_ns"));
  const json& solver = fields.at("solver");
  const RegionHeader common = parse_common(fields, !solver.is_null());
  options.waypoints = common;
  options.waypoints.capacity = fields.take<std::uint64_t>("capacity");
  options.waypoints.epoch = fields.take<std::uint64_t>("epoch");
  options.waypoints.owner_pid = fields.take<std::uint64_t>("pid");
  check_ring(options.waypoints);
  if (solver.is_null()) return options;
  options.spline = common;
  parse_solver(Fields(solver), *options.spline);
  check_board(*options.spline);
  return options;
}

}  // namespace

ordered_json to_json(const StreamOptions& options) {
  const RegionHeader& ring = options.waypoints;
  ordered_json json{{"format", kFormat},
                    {"stream", options.stream},
                    {"stream_id", ring.stream_id},
                    {"clock", kClocks[ring.clock]},
                    {"wall_offset_ns", options.wall_offset.count()},
                    {"dimensions", dimensions_to_json(options)},
                    {"start", to_string(ipc::start_condition(ring))}};
  json.update(intervals_to_json(ring));
  json.update(ordered_json{{"capacity", ring.capacity},
                           {"epoch", ring.epoch},
                           {"pid", ring.owner_pid},
                           {"solver", nullptr}});
  if (ring.law_id != 0) {
    json["law"] = {
        {"name", ipc::text_of(ring.law)}, {"id", ring.law_id}, {"largest_rate", ring.largest_rate}};
  }
  if (ring.is_law != 0) {
    json["time_law"] = {{"origin_ns", ring.law_origin}, {"largest_rate", ring.largest_rate}};
  }
  if (options.spline) json["solver"] = solver_to_json(*options.spline);
  return json;
}

StreamOptions parse_options(std::string_view text) {
  try {
    return parse(json::parse(text));
  } catch (const json::exception& error) {
    throw BadMessage(fmt::format("it is not JSON: {}", ipc::printable(error.what())));
  } catch (const StreamError& error) {
    throw BadMessage(error.what());
  }
}

StreamOptions parse_options(std::span<const std::byte> body) {
  return parse_options(std::string_view(reinterpret_cast<const char*>(body.data()),  // NOLINT
                                        body.size()));
}

std::vector<std::string> names_in_json(const RegionHeader& header) {
  std::vector<std::string> names = ipc::dimension_names(header);
  const std::set<std::string> distinct(names.begin(), names.end());
  if (distinct.size() == names.size() && !distinct.contains("")) return names;
  for (std::size_t d = 0; d < names.size(); ++d) names[d] = std::to_string(d);
  return names;
}

}  // namespace splinecast::apps::record
