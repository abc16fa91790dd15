#include "apps/cli/verb.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/completion/scripts.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const CommandDescription& command) {
  ordered_json arguments = ordered_json::array();
  for (const ArgumentDescription& argument : command.arguments) {
    arguments.push_back({{"names", argument.names},
                         {"value", argument.value},
                         {"help", argument.help},
                         {"positional", argument.is_positional},
                         {"required", argument.is_required},
                         {"list", argument.is_list}});
  }
  ordered_json commands = ordered_json::array();
  for (const CommandDescription& inner : command.commands) commands.push_back(json_of(inner));
  return {{"name", command.name},
          {"summary", command.summary},
          {"arguments", arguments},
          {"commands", commands}};
}

using Script = std::string (*)(const CommandDescription& program);

Script script_named(const std::string& text) {
  if (text == "bash") return bash_script;
  if (text == "zsh") return zsh_script;
  if (text == "json") return json_text;
  throw UsageError("bash|zsh|json", fmt::format("'{}' is not one of bash, zsh, json", text));
}

void add_completion(Command& verb, Action& action) {
  auto script = std::make_shared<Script>();
  verb.option(
          "bash|zsh|json", [script](const std::string& text) { *script = script_named(text); },
          "Shell to print the script for; json: all verbs and options, for other tools")
      .required();
  verb.callback([&action, script, program = verb.parent()] {
    action = [script, program] {
      print_report((*script)(program.description()));
      return kOk;
    };
  });
}

const Verb completion_verb("completion", 150, "Print a completion script for bash or zsh",
                           add_completion);

}  // namespace

std::string json_text(const CommandDescription& program) { return json_of(program).dump(2) + "\n"; }

}  // namespace splinecast::apps
