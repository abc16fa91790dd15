#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/cli/description.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace splinecast::apps {

/// An error of the command line: a message about the argument `name`. The program then ends with
/// exit code 2.
class UsageError : public std::runtime_error {
 public:
  UsageError(const std::string& name, const std::string& why);
};

/// A handle of an option, a flag or a positional argument of a command. Cheap to copy; valid as
/// long as its command.
class Argument {
 public:
  explicit Argument(CLI::Option& option) noexcept : option_(&option) {}

  /// Sets the name of the value in the help, such as SECONDS.
  Argument type(const std::string& name);
  Argument help(const std::string& text);
  Argument required();
  /// For a list: one text may hold several values.
  Argument separated_by_commas();
  Argument needs(const Argument& other);
  Argument excludes(const Argument& other);

  /// Whether the command line contains it. Valid after parsing.
  [[nodiscard]] bool is_given() const;

 private:
  CLI::Option* option_;
};

/// The command line of a verb: its arguments, and the callback after parsing. The variables that it
/// sets must live until then. This header does not include CLI11, which takes seconds to compile.
class Command {
 public:
  explicit Command(CLI::App& app) noexcept : app_(&app) {}

  /// Takes the value, or the list of values, of an option. May throw UsageError.
  using Take = std::function<void(const std::string& text)>;
  using TakeList = std::function<void(const std::vector<std::string>& texts)>;

  /// Adds an option if `names` begin with a dash ("-o,--output"), else a positional argument.
  Argument option(const std::string& names, const Take& take, const std::string& help);
  Argument option(const std::string& names, const TakeList& take, const std::string& help);
  Argument option(const std::string& names, std::string& value, const std::string& help);
  Argument option(const std::string& names, std::optional<std::string>& value,
                  const std::string& help);
  Argument option(const std::string& names, std::vector<std::string>& values,
                  const std::string& help);

  /// Adds a flag that sets `value`, or with `clear` one that clears it.
  Argument flag(const std::string& names, bool& value, const std::string& help);
  Argument clear(const std::string& names, bool& value, const std::string& help);

  Command subcommand(const std::string& name, const std::string& summary);
  /// The command that this one is a subcommand of.
  [[nodiscard]] Command parent() const;
  /// This command with all its arguments and subcommands.
  [[nodiscard]] CommandDescription description() const;
  /// Whether the command line selects this command. Valid after parsing.
  [[nodiscard]] bool is_chosen() const;
  /// The options that the command line contains, by their longest names; no positional arguments.
  /// Valid after parsing.
  [[nodiscard]] std::vector<std::string> given() const;

  /// Sets the function that is called after parsing, if the command line selects this command. The
  /// function may throw UsageError.
  void callback(const std::function<void()>& parsed);

 private:
  CLI::App* app_;
};

}  // namespace splinecast::apps
