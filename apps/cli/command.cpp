#include "apps/cli/command.hpp"

#include <CLI/CLI.hpp>

namespace splinecast::apps {
namespace {

/// Clears the value name of a positional argument: the help shows only the argument's own name.
template <typename Option>
Option* named(Option* option) {
  if (option->get_positional()) option->type_name("");
  return option;
}

ArgumentDescription describe(const CLI::Option& option) {
  ArgumentDescription out{.names = {},
                          .value = option.get_type_name(),
                          .help = option.get_description(),
                          .is_positional = option.get_positional(),
                          .is_required = option.get_required(),
                          .is_list = option.get_expected_max() > 1};
  if (out.is_positional) out.names.push_back(option.get_name(true));
  for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  return out;
}

CommandDescription describe(const CLI::App& app) {
  CommandDescription out{.name = app.get_name(), .summary = app.get_description()};
  for (const CLI::Option* option : app.get_options()) out.arguments.push_back(describe(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    out.commands.push_back(describe(*command));
  }
  return out;
}

}  // namespace

UsageError::UsageError(const std::string& name, const std::string& why)
    : std::runtime_error(name + ": " + why) {}

Argument Argument::type(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Argument Argument::help(const std::string& text) {
  option_->description(text);
  return *this;
}

Argument Argument::required() {
  option_->required();
  return *this;
}

Argument Argument::separated_by_commas() {
  option_->delimiter(',');
  return *this;
}

Argument Argument::needs(const Argument& other) {
  option_->needs(other.option_);
  return *this;
}

Argument Argument::excludes(const Argument& other) {
  option_->excludes(other.option_);
  return *this;
}

bool Argument::is_given() const { return !option_->empty(); }

Argument Command::option(const std::string& names, const Take& take, const std::string& help) {
  return Argument(*named(app_->add_option_function<std::string>(names, take, help)));
}

Argument Command::option(const std::string& names, const TakeList& take, const std::string& help) {
  return Argument(*named(app_->add_option_function<std::vector<std::string>>(names, take, help)));
}

Argument Command::option(const std::string& names, std::string& value, const std::string& help) {
  return Argument(*named(app_->add_option(names, value, help)));
}

Argument Command::option(const std::string& names, std::optional<std::string>& value,
                         const std::string& help) {
  return Argument(*named(app_->add_option(names, value, help)));
}

Argument Command::option(const std::string& names, std::vector<std::string>& values,
                         const std::string& help) {
  return Argument(*named(app_->add_option(names, values, help)));
}

Argument Command::flag(const std::string& names, bool& value, const std::string& help) {
  return Argument(*app_->add_flag(names, value, help));
}

Argument Command::clear(const std::string& names, bool& value, const std::string& help) {
  return Argument(*app_->add_flag_callback(
      names, [&value] { value = false; }, help));
}

Command Command::subcommand(const std::string& name, const std::string& summary) {
  return Command(*app_->add_subcommand(name, summary));
}

Command Command::parent() const { return Command(*app_->get_parent()); }

CommandDescription Command::description() const { return describe(*app_); }

bool Command::is_chosen() const { return app_->parsed(); }

std::vector<std::string> Command::given() const {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app_->get_options()) {
    if (!option->empty() && !option->get_positional()) names.push_back(option->get_name());
  }
  return names;
}

void Command::callback(const std::function<void()>& parsed) { app_->callback(parsed); }

}  // namespace splinecast::apps
