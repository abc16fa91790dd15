#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/tables/waypoints.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

/// Adds `--columns`, `--kind`, `--time-column`, `--time-unit` and `--quiet`.
void add_table_options(Command& verb, TableOptions& options);
void add_time_unit(Command& verb, std::optional<TimeUnit>& unit);

/// The method of this name. Throws UsageError for an unknown name.
[[nodiscard]] const Method& method_named(const std::string& text);

/// Adds the options of a curve that is solved online: `--method`, `--lambda`, `--time-scale`,
/// `--settle`, `--tail`, `--force-lag`.
void add_solver_curve(Command& verb, SolverOptions& options);
/// Adds `--lambda` and `--time-scale`. If `automatic` is not null, `--lambda auto` sets it.
void add_method_options(Command& verb, std::optional<double>& lambda, bool* automatic,
                        std::optional<double>& scale);
/// Adds `--settle`, `--tail` and `--force-lag`.
void add_online_options(Command& verb, std::optional<std::size_t>& settle,
                        std::optional<Tail>& tail, bool& is_forced);

/// The longest time of an option: a time of a stream plus twice this does not overflow.
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
/// Factors and rates that still give valid times.
inline constexpr NumberRange kPositiveNumber{1e-6, 1e9};
inline constexpr CountRange kAnyCount{1, std::size_t{1} << 53U};

/// Add an option for a time in seconds or milliseconds.
Argument add_seconds(Command& verb, const std::string& name, std::optional<Time>& value,
                     const std::string& help, const TimeRange& range = kAnyTime);
Argument add_seconds(Command& verb, const std::string& name, Time& value, const std::string& help,
                     const TimeRange& range = kAnyTime);
Argument add_milliseconds(Command& verb, const std::string& name, Time& value,
                          const std::string& help, const TimeRange& range = kAnyTime);

/// Adds an option for an integer. For an int, the range must fit into int.
Argument add_count(Command& verb, const std::string& name, std::size_t& value,
                   const std::string& help, const CountRange& range = kAnyCount);
Argument add_count(Command& verb, const std::string& name, int& value, const std::string& help,
                   const CountRange& range);
Argument add_count(Command& verb, const std::string& name, std::optional<std::size_t>& value,
                   const std::string& help, const CountRange& range = kAnyCount);

/// Adds an option with two words to choose from. `take` gets whether the user chose the first one.
void add_choice(Command& verb, const std::string& name, const std::string& first,
                const std::string& second, const std::function<void(bool is_first)>& take,
                const std::string& help);

/// Adds an option for a rate in Hz.
void add_rate(Command& verb, const std::string& name, double& value, const std::string& help,
              const NumberRange& range);

/// Parse a number or a time. Throw UsageError, with the text and the range, if it is invalid or out
/// of range.
[[nodiscard]] double number_within(const std::string& name, const std::string& text,
                                   const NumberRange& range = kPositiveNumber);
[[nodiscard]] Time time_within(const std::string& name, const std::string& text, TimeUnit unit,
                               const TimeRange& range = kPositiveTime);

/// Adds `--mode` and `--group`, for new regions.
void add_access(Command& verb, RegionAccess& access);

/// Adds `--owner`: a user whose regions are trusted, in addition to those of this user and of root.
void add_trust(Command& verb, Trust& trust);

}  // namespace splinecast::apps
