#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/tables/waypoints.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

/// `--columns`, `--kind` and `--time-unit`.
void add_table_options(Command& verb, TableOptions& options);
void add_time_unit(Command& verb, std::optional<TimeUnit>& unit);

/// The method of that name; else UsageError.
[[nodiscard]] const Method& method_named(const std::string& text);

/// What shapes a curve that is solved online: `--method`, `--lambda`, `--time-scale`, `--settle`,
/// `--tail`, `--force-lag`.
void add_solver_curve(Command& verb, SolverOptions& options);
void add_force_lag(Command& verb, bool& force_lag);

/// `--lambda`; `automatic`, if not null, is set by `auto`.
void add_lambda(Command& verb, std::optional<double>& lambda, bool* automatic);
void add_time_scale(Command& verb, std::optional<double>& time_scale);

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
void add_condition(Command& verb, const std::string& name, std::optional<Condition>& value,
                   const std::string& help);
void add_tail(Command& verb, std::optional<Tail>& value);
Argument add_settle(Command& verb, std::optional<std::size_t>& value);
Argument add_seconds(Command& verb, const std::string& name, std::optional<Time>& value,
                     const std::string& help, const TimeRange& range = kAnyTime);
Argument add_seconds(Command& verb, const std::string& name, Time& value, const std::string& help,
                     const TimeRange& range = kAnyTime);
Argument add_milliseconds(Command& verb, const std::string& name, Time& value,
                          const std::string& help, const TimeRange& range = kAnyTime);

/// An option that takes a whole number. Into an int, the range must be one of ints.
Argument add_count(Command& verb, const std::string& name, std::size_t& value,
                   const std::string& help, const CountRange& range = kAnyCount);
Argument add_count(Command& verb, const std::string& name, int& value, const std::string& help,
                   const CountRange& range);
Argument add_count(Command& verb, const std::string& name, std::optional<std::size_t>& value,
                   const std::string& help, const CountRange& range = kAnyCount);

/// An option that takes one of two words; `take` is told whether it is the first.
void add_choice(Command& verb, const std::string& name, const std::string& first,
                const std::string& second, const std::function<void(bool is_first)>& take,
                const std::string& help);

/// An option that takes a number a second.
void add_rate(Command& verb, const std::string& name, double& value, const std::string& help,
              const NumberRange& range);

/// The number, or the time, that a text says; UsageError, which names the value and the
/// range, for any other text.
[[nodiscard]] double number_within(const std::string& name, const std::string& text,
                                   const NumberRange& range = kPositiveNumber);
[[nodiscard]] Time time_within(const std::string& name, const std::string& text, TimeUnit unit,
                               const TimeRange& range = kPositiveTime);

/// `--mode` and `--group` of the regions to be made.
void add_access(Command& verb, RegionAccess& access);

/// `--owner`: a user whose regions are trusted besides the own ones and root's.
void add_trust(Command& verb, Trust& trust);

}  // namespace splinecast::apps
