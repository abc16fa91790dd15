#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace splinecast::apps {

/// A command line that is wrong: what the user is told about the argument `name`. The program then
/// ends with exit code 2.
class UsageError : public std::runtime_error {
 public:
  UsageError(const std::string& name, const std::string& why);
};

/// An option, a flag or a positional argument of a command. A handle that is cheap to copy, valid
/// as long as its command.
class Argument {
 public:
  explicit Argument(CLI::Option& option) noexcept : option_(&option) {}

  /// What the help shows for the value: SECONDS.
  Argument type(const std::string& name);
  Argument help(const std::string& text);
  Argument required();
  /// For a list: one text may hold several values.
  Argument separated_by_commas();
  Argument needs(const Argument& other);
  Argument excludes(const Argument& other);

  /// Whether the command line has it; known once it is parsed.
  [[nodiscard]] bool is_given() const;

 private:
  CLI::Option* option_;
};

/// A verb's command line: what it takes, and what is done once it is parsed. What is filled in must
/// live until then. Only its own source file sees CLI11, which takes seconds to compile.
class Command {
 public:
  explicit Command(CLI::App& app) noexcept : app_(&app) {}

  /// What is done with the text, or with the texts, of an option. May throw UsageError.
  using Take = std::function<void(const std::string& text)>;
  using TakeList = std::function<void(const std::vector<std::string>& texts)>;

  /// An option if `names` begin with a dash ("-o,--output"), else a positional argument.
  Argument option(const std::string& names, const Take& take, const std::string& help);
  Argument option(const std::string& names, const TakeList& take, const std::string& help);
  Argument option(const std::string& names, std::string& value, const std::string& help);
  Argument option(const std::string& names, std::optional<std::string>& value,
                  const std::string& help);
  Argument option(const std::string& names, std::vector<std::string>& values,
                  const std::string& help);

  /// A flag sets `value`, or clears it: "!--no-wake".
  Argument flag(const std::string& names, bool& value, const std::string& help);

  Command subcommand(const std::string& name, const std::string& summary);
  /// Whether the command line chose it; known once it is parsed.
  [[nodiscard]] bool is_chosen() const;

  /// Called once the command line is parsed, if it chose this command. May throw UsageError.
  void callback(const std::function<void()>& parsed);

 private:
  CLI::App* app_;
};

}  // namespace splinecast::apps
