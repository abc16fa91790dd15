#include "apps/cli/options.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>

#include <array>
#include <charconv>
#include <chrono>

#include "apps/cli/option_rows.hpp"
#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/kinds.hpp"

namespace splinecast::apps {
namespace {

/// Adds an option for a time. `Target` is Time, or an optional of it.
template <typename Target>
Argument add_time(Command& verb, const std::string& name, Target& value, TimeUnit unit,
                  const std::string& help, const TimeRange& range) {
  return verb
      .option(
          name,
          [&value, name, unit, range](const std::string& text) {
            value = time_within(name, text, unit, range);
          },
          help)
      .type(unit == TimeUnit::seconds ? "SECONDS" : "MS");
}

/// Adds an option for an integer. `Target` is an integer type, or an optional of it.
template <typename Target>
Argument add_number(Command& verb, const std::string& name, Target& value, const std::string& help,
                    const CountRange& range) {
  return verb
      .option(
          name,
          [&value, name, range](const std::string& text) {
            const auto count = parse_count(text);
            if (!count || *count < range.least || *count > range.most) {
              throw UsageError(name, fmt::format("'{}' is not an integer from {} to {}", text,
                                                 range.least, range.most));
            }
            value = static_cast<Target>(*count);
          },
          help)
      .type("N");
}

/// Like parse_kind_option. Also accepts `I:wrap:PERIOD`, the form of earlier versions, with a
/// message on stderr.
std::optional<KindOption> parse_kind(const std::string& text) {
  const auto kind = parse_kind_option(text);
  constexpr std::string_view kOld = ":wrap:";
  const std::size_t at = text.rfind(kOld);
  if (kind || at == std::string::npos) return kind;
  const std::string present = text.substr(0, at) + ":periodic:" + text.substr(at + kOld.size());
  const auto found = parse_kind_option(present);
  if (found) say(fmt::format("--kind: '{}' is now '{}'", text, present));
  return found;
}

std::optional<unsigned> parse_unsigned(const std::string& text, int base) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Options for files with topics: MCAP and ULog.
void add_topic_options(Command& verb, TableOptions& options) {
  verb.option("--topic", options.topic,
              "Topic of an MCAP file or a ULog; of a ULog also TOPIC:INSTANCE; of a recording also "
              "the name of a stream (default: the only one that gives waypoints)")
      .type("TOPIC");
  verb.option("--joints", options.joints,
              "Joints of a topic, by name, in this order (default: those of the first message)")
      .separated_by_commas()
      .type("NAME,...");
  verb.option(
          "--field", options.fields,
          "Numbers in the messages of a topic, in this order: paths such as pose.position.x or "
          "q[0] (default: all numbers of the first JSON message; all floating-point fields of a "
          "ULog)")
      .separated_by_commas()
      .type("PATH,...");
  verb.option(
          "--time",
          [&options](const std::string& text) {
            if (text != "header" && text != "log" && text != "publish") {
              throw UsageError("--time",
                               fmt::format("'{}' is not one of header, log, publish", text));
            }
            options.which_time = text == "header" ? WhichTime::header
                                 : text == "log"  ? WhichTime::log
                                                  : WhichTime::publish;
          },
          "Time of a message: the stamp in its header, or the time when it was recorded or "
          "published "
          "(default: header)")
      .type("header|log|publish");
}

}  // namespace

void add_table_options(Command& verb, TableOptions& options) {
  verb.option("--columns", options.columns,
              "Position columns, by name, in this order (default: all numeric columns)")
      .separated_by_commas()
      .type("NAME,...");
  verb.option(
          "--kind",
          [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              const auto kind = parse_kind(text);
              if (!kind) {
                throw UsageError(
                    "--kind", fmt::format("'{}' is not one of I:linear, I:periodic:PERIOD (1e-100 "
                                          "to 1e100), I:quaternion, I:quaternion-wxyz",
                                          text));
              }
              options.kinds.push_back(*kind);
            }
          },
          "Kinds of position columns, by name or index from 0: I:linear, I:periodic:PERIOD (1e-100 "
          "to "
          "1e100), or I:quaternion or I:quaternion-wxyz, where I is the first of four columns "
          "(default: quaternion for columns named qx qy qz qw or q_..._w to q_..._z, else linear)")
      .separated_by_commas()
      .type("I:K,...");
  verb.option("--time-column", options.time_column,
              "Time column, by name (default: the first one with a name such as t, time, stamp or "
              "timestamp_us)")
      .type("NAME");
  add_time_unit(verb, options.time_unit);
  add_topic_options(verb, options);
  verb.flag("--quiet", options.quiet, "Print no messages about what the columns are read as");
}

void add_time_unit(Command& verb, std::optional<TimeUnit>& unit) {
  verb.option(
          "--time-unit",
          [&unit](const std::string& text) {
            unit = parse_time_unit(text);
            if (!unit) {
              throw UsageError("--time-unit",
                               fmt::format("'{}' is not one of ns, us, ms, s", text));
            }
          },
          "Unit of the time column (default: from its name, else s)")
      .type("ns|us|ms|s");
}

const Method& method_named(const std::string& text) {
  const Method* const method = find_method(text);
  if (method != nullptr) return *method;
  throw UsageError("--method", fmt::format("'{}' is not one of {}", text, method_names(false)));
}

void add_solver_curve(Command& verb, SolverOptions& options) {
  verb.option(
          "--method",
          [&options](const std::string& text) {
            options.method = &method_named(text);
            if (options.method->streams()) return;
            throw UsageError(
                "--method",
                fmt::format("{} needs all waypoints at once: only 'fit' supports it", text));
          },
          fmt::format("Interpolant: {} (default c2)", method_names(true)))
      .type("METHOD");
  add_method_options(verb, options.lambda, nullptr, options.time_scale);
  add_online_options(verb, options.settle, options.tail, options.force_lag);
}

void add_method_options(Command& verb, std::optional<double>& lambda, bool* automatic,
                        std::optional<double>& scale) {
  if (automatic == nullptr) {
    add_curve_option<&SolverOptions::lambda>(verb, lambda, "L");
  } else {
    verb.option(
            "--lambda",
            [&lambda, automatic](const std::string& text) {
              *automatic = text == "auto";
              if (!*automatic) lambda = row_value(ipc::option_of<&SolverOptions::lambda>(), text);
            },
            "Smoothing parameter λ of the method smoothing: 0 to 1e100 s³, or auto: by generalised "
            "cross-validation (default auto)")
        .type("L|auto");
  }
  add_curve_option<&SolverOptions::time_scale>(verb, scale, "SECONDS");
}

void add_online_options(Command& verb, std::optional<std::size_t>& settle,
                        std::optional<Tail>& tail, bool& is_forced) {
  add_curve_option<&SolverOptions::settle>(verb, settle, "K");
  add_curve_option<&SolverOptions::tail>(verb, tail, "bessel|parabolic|natural|clamped");
  add_curve_flag<&SolverOptions::force_lag>(verb, is_forced);
}

Argument add_seconds(Command& verb, const std::string& name, std::optional<Time>& value,
                     const std::string& help, const TimeRange& range) {
  return add_time(verb, name, value, TimeUnit::seconds, help, range);
}

Argument add_seconds(Command& verb, const std::string& name, Time& value, const std::string& help,
                     const TimeRange& range) {
  return add_time(verb, name, value, TimeUnit::seconds, help, range);
}

Argument add_milliseconds(Command& verb, const std::string& name, Time& value,
                          const std::string& help, const TimeRange& range) {
  return add_time(verb, name, value, TimeUnit::milliseconds, help, range);
}

Argument add_count(Command& verb, const std::string& name, std::size_t& value,
                   const std::string& help, const CountRange& range) {
  return add_number(verb, name, value, help, range);
}

Argument add_count(Command& verb, const std::string& name, int& value, const std::string& help,
                   const CountRange& range) {
  return add_number(verb, name, value, help, range);
}

Argument add_count(Command& verb, const std::string& name, std::optional<std::size_t>& value,
                   const std::string& help, const CountRange& range) {
  return add_number(verb, name, value, help, range);
}

void add_choice(Command& verb, const std::string& name, const std::string& first,
                const std::string& second, const std::function<void(bool is_first)>& take,
                const std::string& help) {
  const auto read = [=](const std::string& text) {
    if (text != first && text != second) {
      throw UsageError(name, fmt::format("'{}' is neither {} nor {}", text, first, second));
    }
    take(text == first);
  };
  verb.option(name, read, help).type(first + "|" + second);
}

void add_rate(Command& verb, const std::string& name, double& value, const std::string& help,
              const NumberRange& range) {
  verb.option(
          name,
          [&value, name, range](const std::string& text) {
            value = number_within(name, text, range);
          },
          help)
      .type("HZ");
}

Time time_within(const std::string& name, const std::string& text, TimeUnit unit,
                 const TimeRange& range) {
  const auto time = parse_time(text, unit);
  if (time && *time >= range.least && *time <= range.most) return *time;
  const bool is_seconds = unit == TimeUnit::seconds;
  const double scale = is_seconds ? 1 : 1e3;
  throw UsageError(name, fmt::format("'{}' is not a time from {:.15g} to {:.15g} {}", text,
                                     to_seconds(range.least) * scale,
                                     to_seconds(range.most) * scale, is_seconds ? "s" : "ms"));
}

double number_within(const std::string& name, const std::string& text, const NumberRange& range) {
  const auto number = parse_number(text);
  if (number && *number >= range.least && *number <= range.most) return *number;
  throw UsageError(
      name, fmt::format("'{}' is not a number from {} to {}", text, range.least, range.most));
}

void add_access(Command& verb, RegionAccess& access) {
  verb.option(
          "--mode",
          [&access](const std::string& text) {
            const auto mode = parse_unsigned(text, 8);
            constexpr unsigned kAllowed = 0644;
            if (!mode || (*mode & ~kAllowed) != 0 || (*mode & 0600U) != 0600U) {
              throw UsageError(
                  "--mode", fmt::format("'{}' is not one of 0600, 0640, 0604, 0644: only the owner "
                                        "may write",
                                        text));
            }
            access.mode = static_cast<mode_t>(*mode);
          },
          "Permissions of a new region, octal: 0600, 0640, 0604 or 0644 (default 0600)")
      .type("MODE");
  verb.option(
          "--group",
          [&access](const std::string& text) {
            const group* const entry = getgrnam(text.c_str());
            const auto number = parse_unsigned(text, 10);
            if (entry == nullptr && !number) {
              throw UsageError("--group", fmt::format("there is no group '{}'", text));
            }
            access.group = entry != nullptr ? entry->gr_gid : static_cast<gid_t>(*number);
          },
          "Group of a new region, by name or number (default: the group of this process)")
      .type("GROUP");
}

void add_trust(Command& verb, Trust& trust) {
  verb.option(
          "--owner",
          [&trust](const std::string& text) {
            const passwd* const entry = getpwnam(text.c_str());
            const auto number = parse_unsigned(text, 10);
            if (entry == nullptr && !number) {
              throw UsageError("--owner", fmt::format("there is no user '{}'", text));
            }
            trust.owner = entry != nullptr ? entry->pw_uid : static_cast<uid_t>(*number);
          },
          "Also trust regions of this user, by name or number (default: only those of this user "
          "and root)")
      .type("USER");
}

}  // namespace splinecast::apps
