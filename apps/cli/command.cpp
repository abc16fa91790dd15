#include "apps/cli/command.hpp"

#include <CLI/CLI.hpp>

namespace splinecast::apps {

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
  return Argument(*app_->add_option_function<std::string>(names, take, help));
}

Argument Command::option(const std::string& names, const TakeList& take, const std::string& help) {
  return Argument(*app_->add_option_function<std::vector<std::string>>(names, take, help));
}

Argument Command::option(const std::string& names, std::string& value, const std::string& help) {
  return Argument(*app_->add_option(names, value, help));
}

Argument Command::option(const std::string& names, std::optional<std::string>& value,
                         const std::string& help) {
  return Argument(*app_->add_option(names, value, help));
}

Argument Command::option(const std::string& names, std::vector<std::string>& values,
                         const std::string& help) {
  return Argument(*app_->add_option(names, values, help));
}

Argument Command::flag(const std::string& names, bool& value, const std::string& help) {
  return Argument(*app_->add_flag(names, value, help));
}

Command Command::subcommand(const std::string& name, const std::string& summary) {
  return Command(*app_->add_subcommand(name, summary));
}

bool Command::is_chosen() const { return app_->parsed(); }

void Command::callback(const std::function<void()>& parsed) { app_->callback(parsed); }

}  // namespace splinecast::apps
