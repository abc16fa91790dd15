#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/basics/number_text.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "splinecast.h"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"

/// The options of a curve that are numbers, times or words: one row each. The rows give what is
/// written to a board's header, the ranges of options and of headers, the comparison with a board
/// that is taken over, the members of the C struct, the keywords of Python, and the fields of JSON.
/// A program reads and writes an option in a loop over them.
namespace splinecast::ipc {

namespace detail {

template <typename Value>
struct Unwrapped {
  using type = Value;
};
template <typename Value>
struct Unwrapped<std::optional<Value>> {
  using type = Value;
};
template <auto Member>
struct ValueOf;
template <typename Struct, typename Value, Value Struct::*Member>
struct ValueOf<Member> {
  using type = typename Unwrapped<Value>::type;
};

}  // namespace detail

/// The values of an option: as a text, and as limits, both included.
template <typename Value>
struct ValueRange {
  std::string_view text;
  Value least;
  Value most;
};

/// One option: its members of SolverOptions, of RegionHeader and of the C struct.
template <auto Option, auto Field, auto InC>
struct CurveOption {
  using Value = typename detail::ValueOf<Option>::type;
  static constexpr auto kOption = Option;
  static constexpr auto kField = Field;
  static constexpr auto kInC = InC;

  std::string_view key;      ///< its name in C++, C and Python, and with its unit in JSON
  std::string_view name;     ///< its name in messages
  std::string_view meaning;  ///< what it is, for help texts
  ValueRange<Value> range;
  std::string_view initial;  ///< its default, for help texts; empty: it has none
  Value preset;              ///< its default, unless write_options computes another
};

inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();
/// Upper limits of freeze-ahead and history, larger than any that is of use.
inline constexpr Time kLongestFreeze = std::chrono::minutes(1);
inline constexpr Time kLongestHistory = std::chrono::hours(24);

inline constexpr std::tuple kCurveOptions{
    CurveOption<&SolverOptions::lambda, &RegionHeader::lambda, &splinecast_solver_options::lambda>{
        "lambda",
        "lambda",
        "Smoothing parameter λ, which the method smoothing needs",
        {"0 to 1e100 s³", 0, kLargestValue},
        "",
        0},
    CurveOption<&SolverOptions::time_scale, &RegionHeader::time_scale,
                &splinecast_solver_options::time_scale>{
        "time_scale",
        "time scale",
        "Of the method rounded: time that counts as one unit of position",
        {"above 0, at most 1e100 s", kAboveZero, kLargestValue},
        "default 1 s",
        1},
    CurveOption<&SolverOptions::settle, &RegionHeader::settle, &splinecast_solver_options::settle>{
        "settle",
        "settle lag",
        "Settle lag K: number of newer knots after which a knot no longer changes",
        {"0 to 64", 0, core::kMaxSettle},
        "default 8 for c2, 64 for smoothing, else the look-ahead of the method",
        0},
    CurveOption<&SolverOptions::tail, &RegionHeader::tail, &splinecast_solver_options::tail>{
        "tail",
        "tail",
        "Condition at the newest knot while the stream continues",
        {"bessel, parabolic, natural or clamped", Tail::bessel, Tail::clamped},
        "default bessel",
        Tail::bessel},
    CurveOption<&SolverOptions::stop_time, &RegionHeader::stop_time,
                &splinecast_solver_options::stop_time>{
        "stop_time",
        "stop time",
        "Length of the stop segment, in which a starved stream comes to rest; with a limit of "
        "acceleration or jerk, its least length",
        {"above 0, at most 2⁶⁰ ns", Time(1), kLongestStop},
        "default 250 ms",
        Time(250'000'000)},
    CurveOption<&SolverOptions::force_lag, &RegionHeader::force_lag,
                &splinecast_solver_options::force_lag>{
        "force_lag",
        "forced lag",
        "Of the method smoothing: accept a settle lag that is too short for λ",
        {"0 or 1", false, true},
        "",
        false},
    CurveOption<&SolverOptions::freeze_ahead, &RegionHeader::freeze_ahead,
                &splinecast_solver_options::freeze_ahead>{
        "freeze_ahead",
        "freeze-ahead",
        "Of live streams: the curve is settled this long ahead of now",
        {"1 ns to 1 min", Time(1), kLongestFreeze},
        "default 5 ms",
        Time(5'000'000)},
    CurveOption<&SolverOptions::history, &RegionHeader::history,
                &splinecast_solver_options::history>{
        "history",
        "history",
        "Of live streams: segments that ended less than this ago are kept; no waypoint is consumed "
        "that would overwrite them",
        {"0 to 24 h", Time::zero(), kLongestHistory},
        "default 1 s",
        Time(1'000'000'000)},
    CurveOption<&SolverOptions::min_entry, &RegionHeader::min_entry,
                &splinecast_solver_options::min_entry>{"min_entry",
                                                       "shortest entry",
                                                       "Of live streams: least length of an entry",
                                                       {"1 ns to 1 min", Time(1), kLongestFreeze},
                                                       "default freeze_ahead",
                                                       Time(5'000'000)},
    CurveOption<&SolverOptions::beyond, &RegionHeader::beyond, &splinecast_solver_options::beyond>{
        "beyond",
        "action beyond the limits",
        "What to do with a waypoint that makes the curve exceed a limit: report it, refuse it, or "
        "leave the spline for an entry within the limits",
        {"report, refuse or enter", Beyond::report, Beyond::enter},
        "default report",
        Beyond::report},
    CurveOption<&SolverOptions::capacity, &RegionHeader::capacity,
                &splinecast_solver_options::capacity>{
        "capacity",
        "capacity",
        "Segments of history; rounded up to a power of two",
        {"2(K + 6) + 2 to 2²²", 2, kMaxBoardCapacity},
        "default 4,096",
        4096},
    CurveOption<&SolverOptions::largest_rate, &RegionHeader::largest_rate,
                &splinecast_solver_options::largest_rate>{
        "largest_rate",
        "largest rate",
        "Of a time law: the largest rate that a commander may request",
        {"above 0, at most 100", kAboveZero, kLargestRate},
        "default 1",
        1},
};

/// Calls `visit` with each row.
template <typename Visit>
constexpr void for_each_option(const Visit& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, kCurveOptions);
}

/// The number of the row of an option; the number of rows if there is none.
template <auto Option, typename... Rows>
[[nodiscard]] consteval std::size_t row_number(const std::tuple<Rows...>& /*rows*/) {
  std::size_t number = 0;
  std::size_t found = sizeof...(Rows);
  const auto compare = [&]<typename Row>() {
    if constexpr (std::is_same_v<decltype(Option), std::remove_const_t<decltype(Row::kOption)>>) {
      if (Row::kOption == Option) found = number;
    }
    ++number;
  };
  (compare.template operator()<Rows>(), ...);
  return found;
}

/// The row of a member of SolverOptions. A member without a row is a compile-time error.
template <auto Option>
[[nodiscard]] consteval const auto& option_of() {
  return std::get<row_number<Option>(kCurveOptions)>(kCurveOptions);
}

/// Whether a row is one of a member of SolverOptions.
template <auto Option, typename Row>
inline constexpr bool kIsRowOf =
    std::is_same_v<std::remove_cvref_t<decltype(option_of<Option>())>, std::remove_cvref_t<Row>>;

/// Whether a row is one of time laws only.
template <typename Row>
inline constexpr bool kIsOfLaw = kIsRowOf<&SolverOptions::largest_rate, Row>;

/// Whether a stream's header has the option.
template <typename Row>
[[nodiscard]] constexpr bool has_option(const Row& /*row*/, const RegionHeader& header) noexcept {
  return !kIsOfLaw<Row> || header.is_law != 0;
}

/// An option's value, if it is set: a flag always is.
template <typename Row>
[[nodiscard]] constexpr std::optional<typename Row::Value> value_in(const Row& /*row*/,
                                                                    const SolverOptions& options) {
  return options.*Row::kOption;
}
/// Whether it is set; of a flag, whether it is given.
template <typename Row>
[[nodiscard]] constexpr bool is_set(const Row& /*row*/, const SolverOptions& options) noexcept {
  return static_cast<bool>(options.*Row::kOption);
}
/// Its value in a header.
template <typename Row>
[[nodiscard]] constexpr typename Row::Value value_in(const Row& /*row*/,
                                                     const RegionHeader& header) noexcept {
  return static_cast<typename Row::Value>(header.*Row::kField);
}
template <typename Row>
constexpr void put_value(const Row& /*row*/, typename Row::Value value,
                         RegionHeader& header) noexcept {
  auto& field = header.*Row::kField;
  if constexpr (std::is_same_v<typename Row::Value, Time>) {
    field = value.count();
  } else {
    field = static_cast<std::remove_reference_t<decltype(field)>>(value);
  }
}

/// Whether a value is within an option's range; a NaN is not.
template <typename Row>
[[nodiscard]] constexpr bool is_in_range(const Row& row, typename Row::Value value) noexcept {
  return value >= row.range.least && value <= row.range.most;
}

/// The value in messages, with its unit.
[[nodiscard]] inline std::string value_text(Time value) {
  return std::to_string(value.count()) + " ns";
}
[[nodiscard]] inline std::string value_text(double value) { return core::number_text(value); }
template <std::integral Value>
[[nodiscard]] std::string value_text(Value value) {
  return std::to_string(value);
}
template <typename Value>
requires std::is_enum_v<Value>
[[nodiscard]] std::string value_text(Value value) { return std::string(to_string(value)); }

/// The value of a word as value_text writes it; nothing for another text.
template <typename Value>
[[nodiscard]] std::optional<Value> value_of_word(std::string_view text) {
  if constexpr (std::is_same_v<Value, Tail>) {
    return parse_tail(text);
  } else {
    static_assert(std::is_same_v<Value, Beyond>);
    return parse_beyond(text);
  }
}

/// Says that a value is out of its option's range.
template <typename Row>
[[nodiscard]] std::string out_of_range(const Row& row, typename Row::Value value) {
  return std::string(row.name) + " must be " + std::string(row.range.text) + ", not " +
         value_text(value);
}

[[nodiscard]] constexpr Time& min_interval_of(ProducerOptions& options) noexcept {
  return options.limits.min_interval;
}
[[nodiscard]] constexpr Time& max_interval_of(ProducerOptions& options) noexcept {
  return options.limits.max_interval;
}
[[nodiscard]] constexpr Time& horizon_of(ProducerOptions& options) noexcept {
  return options.horizon;
}
[[nodiscard]] constexpr double& start_tolerance_of(ProducerOptions& options) noexcept {
  return options.start_tolerance;
}
[[nodiscard]] constexpr std::size_t& capacity_of(ProducerOptions& options) noexcept {
  return options.capacity;
}

/// One option: where it is in ProducerOptions, in the C struct and, unless null, in the header.
template <auto Option, auto InC, auto Field>
struct StreamOption {
  using Value = std::remove_reference_t<decltype(Option(std::declval<ProducerOptions&>()))>;
  static constexpr auto kOption = Option;
  static constexpr auto kInC = InC;
  static constexpr auto kField = Field;
  static constexpr bool kHasField = !std::is_null_pointer_v<decltype(Field)>;

  std::string_view key;
  std::string_view name;
  std::string_view meaning;
  ValueRange<Value> range;
  std::string_view initial;
};

/// The options of a stream that are numbers or times: one row each, used as those of kCurveOptions.
/// They always have a value.
inline constexpr std::tuple kStreamOptions{
    StreamOption<&min_interval_of, &splinecast_producer_options::min_interval,
                 &RegionHeader::min_interval>{"min_interval",
                                              "shortest interval",
                                              "Shortest interval between two waypoints",
                                              {"1 ns or more", Time(1), kLatestTime / 2},
                                              "default 1 µs"},
    StreamOption<&max_interval_of, &splinecast_producer_options::max_interval,
                 &RegionHeader::max_interval>{
        "max_interval",
        "longest interval",
        "Longest interval between two waypoints",
        {"min_interval or more, below 2⁶¹ ns", Time(1), kLatestTime / 2},
        "default 1 h"},
    StreamOption<&horizon_of, &splinecast_producer_options::horizon, nullptr>{
        "horizon",
        "horizon",
        "Of a live stream without a law: how far ahead of now a time may be",
        {"above 0", Time(1), Time::max()},
        "default 1 h"},
    StreamOption<&start_tolerance_of, &splinecast_producer_options::start_tolerance, nullptr>{
        "start_tolerance",
        "start tolerance",
        "Of a live stream: how far the first waypoint may be from where an earlier stream of this "
        "name has left the machine, in a dimension without limits",
        {"0 or more", 0, std::numeric_limits<double>::max()},
        "default 0.001"},
    StreamOption<&capacity_of, &splinecast_producer_options::capacity, &RegionHeader::capacity>{
        "capacity",
        "capacity",
        "Items of the ring; rounded up to a power of two",
        {"2 to 2²⁴", 2, kMaxRingCapacity},
        "default 1,024"},
};

/// Calls `visit` with each row.
template <typename Visit>
constexpr void for_each_stream_option(const Visit& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, kStreamOptions);
}

/// The row of an option. An option without a row is a compile-time error.
template <auto Option>
[[nodiscard]] consteval const auto& stream_option() {
  return std::get<row_number<Option>(kStreamOptions)>(kStreamOptions);
}

}  // namespace splinecast::ipc
