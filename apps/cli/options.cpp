#include "apps/cli/options.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>

#include <array>
#include <charconv>
#include <chrono>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/kinds.hpp"

namespace splinecast::apps {
namespace {

/// An option that takes a time; `Target` is a time, or an optional one.
template <typename Target>
void add_time(CLI::App& verb, const std::string& name, Target& value, TimeUnit unit,
              const std::string& help, const TimeRange& range) {
  verb.add_option_function<std::string>(
          name,
          [&value, name, unit, range](const std::string& text) {
            value = time_within(name, text, unit, range);
          },
          help)
      ->type_name(unit == TimeUnit::seconds ? "SECONDS" : "MS");
}

/// An option that takes a count; `Target` is a number, or an optional one.
template <typename Target>
void add_number(CLI::App& verb, const std::string& name, Target& value, const std::string& help,
                const CountRange& range) {
  verb.add_option_function<std::string>(
          name,
          [&value, name, range](const std::string& text) {
            const auto count = parse_count(text);
            if (!count || *count < range.least || *count > range.most) {
              throw CLI::ValidationError(name, fmt::format("'{}' is no whole number from {} to {}",
                                                           text, range.least, range.most));
            }
            value = *count;
          },
          help)
      ->type_name("N");
}

std::optional<unsigned> parse_unsigned(const std::string& text, int base) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

void add_table_options(CLI::App& verb, TableOptions& options) {
  verb.add_option("--columns", options.columns, "Position columns to use, by name")
      ->delimiter(',')
      ->type_name("NAME,...");
  verb.add_option_function<std::vector<std::string>>(
          "--kind",
          [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              const auto kind = parse_kind_option(text);
              if (!kind) {
                throw CLI::ValidationError(
                    "--kind", fmt::format("'{}' is no I:linear, I:wrap:PERIOD (1e-100 to 1e100), "
                                          "I:quaternion or I:quaternion-wxyz",
                                          text));
              }
              options.kinds.push_back(*kind);
            }
          },
          "Kinds of position columns, by name or index from 0: I:linear, I:wrap:PERIOD, or "
          "I:quaternion, of which I is the first of four (default: quaternion for columns named "
          "qx qy qz qw or q_..._w to q_..._z, else linear)")
      ->delimiter(',')
      ->type_name("I:K,...");
  add_time_unit(verb, options.time_unit);
}

void add_time_unit(CLI::App& verb, std::optional<TimeUnit>& unit) {
  verb.add_option_function<std::string>(
          "--time-unit",
          [&unit](const std::string& text) {
            unit = parse_time_unit(text);
            if (!unit) {
              throw CLI::ValidationError("--time-unit",
                                         fmt::format("'{}' is none of ns, us, ms, s", text));
            }
          },
          "Unit of the time column, whatever its name says: ns, us, ms or s")
      ->type_name("UNIT");
}

const Method& method_named(const std::string& text) {
  const Method* const method = find_method(text);
  if (method != nullptr) return *method;
  throw CLI::ValidationError("--method",
                             fmt::format("'{}' is none of {}", text, method_names(false)));
}

void add_lambda(CLI::App& verb, std::optional<double>& lambda, bool* automatic) {
  verb.add_option_function<std::string>(
          "--lambda",
          [&lambda, automatic](const std::string& text) {
            if (automatic != nullptr && text == "auto") {
              *automatic = true;
              return;
            }
            lambda = parse_number(text);
            if (lambda && *lambda >= 0 && is_usable(*lambda)) return;
            throw CLI::ValidationError("--lambda",
                                       fmt::format("'{}' is no number from 0 to 1e100", text));
          },
          automatic == nullptr
              ? "How much smoothing smooths, in s^3"
              : "How much smoothing smooths, in s^3, or auto (default): by cross-validation")
      ->type_name(automatic == nullptr ? "L" : "L|auto");
}

void add_time_scale(CLI::App& verb, std::optional<double>& time_scale) {
  verb.add_option_function<std::string>(
          "--time-scale",
          [&time_scale](const std::string& text) {
            time_scale = number_within("--time-scale", text);
          },
          "For rounded: seconds that count as one unit of position (default 1)")
      ->type_name("SECONDS");
}

void add_solver_curve(CLI::App& verb, SolverOptions& options) {
  verb.add_option_function<std::string>(
          "--method",
          [&options](const std::string& text) {
            options.method = &method_named(text);
            if (options.method->streams()) return;
            throw CLI::ValidationError(
                "--method", fmt::format("{} needs all waypoints at once: only 'fit' has it", text));
          },
          fmt::format("Interpolant: {} (default c2)", method_names(true)))
      ->type_name("METHOD");
  add_lambda(verb, options.lambda, nullptr);
  add_time_scale(verb, options.time_scale);
  add_settle(verb, options.settle);
  add_tail(verb, options.tail);
  add_force_lag(verb, options.force_lag);
}

void add_force_lag(CLI::App& verb, bool& force_lag) {
  verb.add_flag("--force-lag", force_lag, "Smooth also with a settle lag too short for lambda");
}

void add_condition(CLI::App& verb, const std::string& name, std::optional<Condition>& value,
                   const std::string& help) {
  verb.add_option_function<std::string>(
          name,
          [&value, name](const std::string& text) {
            value = parse_condition(text);
            if (value) return;
            throw CLI::ValidationError(
                name, fmt::format("'{}' is none of natural, rest, halt, velocity=N,..., "
                                  "acceleration=N,..., not-a-knot, periodic",
                                  text));
          },
          help)
      ->type_name("CONDITION");
}

void add_tail(CLI::App& verb, std::optional<Tail>& value) {
  verb.add_option_function<std::string>(
          "--tail",
          [&value](const std::string& text) {
            value = parse_tail(text);
            if (value) return;
            throw CLI::ValidationError(
                "--tail", fmt::format("'{}' is none of bessel, parabolic, natural, rest", text));
          },
          "Condition at the newest waypoint while the stream goes on: bessel (default), "
          "parabolic, natural, rest")
      ->type_name("TAIL");
}

void add_settle(CLI::App& verb, std::optional<std::size_t>& value) {
  verb.add_option_function<std::string>(
          "--settle",
          [&value](const std::string& text) {
            value = parse_count(text);
            if (value && *value <= core::kMaxSettle) return;
            throw CLI::ValidationError("--settle",
                                       fmt::format("'{}' is no whole number from 0 to 64", text));
          },
          "Settle lag: newer waypoints after which a knot is final, 0 to 64 (default 8 for c2, 64 "
          "for "
          "smoothing, else what the method looks ahead)")
      ->type_name("K");
}

void add_seconds(CLI::App& verb, const std::string& name, std::optional<Time>& value,
                 const std::string& help, const TimeRange& range) {
  add_time(verb, name, value, TimeUnit::seconds, help, range);
}

void add_seconds(CLI::App& verb, const std::string& name, Time& value, const std::string& help,
                 const TimeRange& range) {
  add_time(verb, name, value, TimeUnit::seconds, help, range);
}

void add_milliseconds(CLI::App& verb, const std::string& name, Time& value, const std::string& help,
                      const TimeRange& range) {
  add_time(verb, name, value, TimeUnit::milliseconds, help, range);
}

void add_count(CLI::App& verb, const std::string& name, std::size_t& value, const std::string& help,
               const CountRange& range) {
  add_number(verb, name, value, help, range);
}

void add_count(CLI::App& verb, const std::string& name, std::optional<std::size_t>& value,
               const std::string& help, const CountRange& range) {
  add_number(verb, name, value, help, range);
}

void add_rate(CLI::App& verb, const std::string& name, double& value, const std::string& help,
              const NumberRange& range) {
  verb.add_option_function<std::string>(
          name,
          [&value, name, range](const std::string& text) {
            value = number_within(name, text, range);
          },
          help)
      ->type_name("HZ");
}

Time time_within(const std::string& name, const std::string& text, TimeUnit unit,
                 const TimeRange& range) {
  const auto time = parse_time(text, unit);
  if (time && *time >= range.least && *time <= range.most) return *time;
  const bool is_seconds = unit == TimeUnit::seconds;
  const double scale = is_seconds ? 1 : 1e3;
  throw CLI::ValidationError(
      name, fmt::format("'{}' is no time from {:.15g} to {:.15g} {}", text,
                        to_seconds(range.least) * scale, to_seconds(range.most) * scale,
                        is_seconds ? "s" : "ms"));
}

double number_within(const std::string& name, const std::string& text, const NumberRange& range) {
  const auto number = parse_number(text);
  if (number && *number >= range.least && *number <= range.most) return *number;
  throw CLI::ValidationError(
      name, fmt::format("'{}' is no number from {} to {}", text, range.least, range.most));
}

void add_access(CLI::App& verb, RegionAccess& access) {
  verb.add_option_function<std::string>(
          "--mode",
          [&access](const std::string& text) {
            const auto mode = parse_unsigned(text, 8);
            constexpr unsigned kAllowed = 0644;
            if (!mode || (*mode & ~kAllowed) != 0 || (*mode & 0600U) != 0600U) {
              throw CLI::ValidationError(
                  "--mode", fmt::format("'{}' is none of 0600, 0640, 0604, 0644: only the owner "
                                        "may write",
                                        text));
            }
            access.mode = static_cast<mode_t>(*mode);
          },
          "Permissions of the region to be made, in octal (default 0600)")
      ->type_name("MODE");
  verb.add_option_function<std::string>(
          "--group",
          [&access](const std::string& text) {
            const group* const entry = getgrnam(text.c_str());
            const auto number = parse_unsigned(text, 10);
            if (entry == nullptr && !number) {
              throw CLI::ValidationError("--group", fmt::format("there is no group '{}'", text));
            }
            access.group = entry != nullptr ? entry->gr_gid : static_cast<gid_t>(*number);
          },
          "Group of the region to be made")
      ->type_name("GROUP");
}

void add_trust(CLI::App& verb, Trust& trust) {
  verb.add_option_function<std::string>(
          "--owner",
          [&trust](const std::string& text) {
            const passwd* const entry = getpwnam(text.c_str());
            const auto number = parse_unsigned(text, 10);
            if (entry == nullptr && !number) {
              throw CLI::ValidationError("--owner", fmt::format("there is no user '{}'", text));
            }
            trust.owner = entry != nullptr ? entry->pw_uid : static_cast<uid_t>(*number);
          },
          "Trust regions of this user too, besides one's own and root's")
      ->type_name("USER");
}

}  // namespace splinecast::apps
