#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/tables/waypoints.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

/// `--columns`, `--kind` and `--time-unit`.
void add_table_options(CLI::App& verb, TableOptions& options);
void add_time_unit(CLI::App& verb, std::optional<TimeUnit>& unit);

/// The method of that name; else CLI::ValidationError.
[[nodiscard]] const Method& method_named(const std::string& text);

/// What shapes a curve that is solved online: `--method`, `--lambda`, `--time-scale`, `--settle`,
/// `--tail`, `--force-lag`.
void add_solver_curve(CLI::App& verb, SolverOptions& options);
void add_force_lag(CLI::App& verb, bool& force_lag);

/// `--lambda`; `automatic`, if not null, is set by `auto`.
void add_lambda(CLI::App& verb, std::optional<double>& lambda, bool* automatic);
void add_time_scale(CLI::App& verb, std::optional<double>& time_scale);

/// The longest time that an option takes: two of them can still be added to a time of a stream.
inline constexpr Time kLongestTime = std::chrono::hours(24 * 366 * 100);

/// The least and the largest value of an option.
template <typename T>
struct OptionRange {
  T least;
  T most;
};
using TimeRange = OptionRange<Time>;
using NumberRange = OptionRange<double>;
using CountRange = OptionRange<std::size_t>;

inline constexpr TimeRange kAnyTime{Time::zero(), kLongestTime};
inline constexpr TimeRange kPositiveTime{Time(1), kLongestTime};
/// Factors and rates of which times can still be made.
inline constexpr NumberRange kPositiveNumber{1e-6, 1e9};
inline constexpr CountRange kAnyCount{1, std::size_t{1} << 53U};

/// An option that takes a condition, a tail, a settle lag, or a time in seconds or milliseconds.
void add_condition(CLI::App& verb, const std::string& name, std::optional<Condition>& value,
                   const std::string& help);
void add_tail(CLI::App& verb, std::optional<Tail>& value);
void add_settle(CLI::App& verb, std::optional<std::size_t>& value);
void add_seconds(CLI::App& verb, const std::string& name, std::optional<Time>& value,
                 const std::string& help, const TimeRange& range = kAnyTime);
void add_seconds(CLI::App& verb, const std::string& name, Time& value, const std::string& help,
                 const TimeRange& range = kAnyTime);
void add_milliseconds(CLI::App& verb, const std::string& name, Time& value, const std::string& help,
                      const TimeRange& range = kAnyTime);

/// An option that takes a whole number.
void add_count(CLI::App& verb, const std::string& name, std::size_t& value, const std::string& help,
               const CountRange& range = kAnyCount);
void add_count(CLI::App& verb, const std::string& name, std::optional<std::size_t>& value,
               const std::string& help, const CountRange& range = kAnyCount);

/// An option that takes a number a second.
void add_rate(CLI::App& verb, const std::string& name, double& value, const std::string& help,
              const NumberRange& range);

/// The number, or the time, that a text says; CLI::ValidationError, which names the value and the
/// range, for any other text.
[[nodiscard]] double number_within(const std::string& name, const std::string& text,
                                   const NumberRange& range = kPositiveNumber);
[[nodiscard]] Time time_within(const std::string& name, const std::string& text, TimeUnit unit,
                               const TimeRange& range = kPositiveTime);

/// `--mode` and `--group` of the regions to be made.
void add_access(CLI::App& verb, RegionAccess& access);

/// `--owner`: a user whose regions are trusted besides the own ones and root's.
void add_trust(CLI::App& verb, Trust& trust);

}  // namespace splinecast::apps
