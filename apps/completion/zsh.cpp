#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "apps/completion/scripts.hpp"
#include "apps/completion/template.hpp"
#include "apps/completion/values.hpp"

namespace splinecast::apps {
namespace {

/// The text in single quotes, with the characters escaped that separate the parts of a
/// specification of `_arguments`.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return out;
}

/// The action of `_arguments` that completes a value; a space for none.
std::string action_of(const ValueCompletion& how) {
  std::vector<std::string> actions;
  if (how.files) actions.emplace_back("_files");
  if (how.streams) actions.emplace_back("_splinecast_streams");
  if (how.users) actions.emplace_back("_users");
  if (how.groups) actions.emplace_back("_groups");
  if (!how.words.empty()) {
    if (actions.empty()) return fmt::format("({})", fmt::join(how.words, " "));
    actions.push_back(fmt::format("_values value {}", fmt::join(how.words, " ")));
  }
  if (actions.size() > 1) return fmt::format("_splinecast_any {}", fmt::join(actions, " "));
  return actions.empty() ? " " : actions.front();
}

std::string option_line(const ArgumentDescription& argument, const std::string& name) {
  const std::string value = argument.value.empty()
                                ? std::string()
                                : fmt::format(":{}:{}", escaped(argument.value),
                                              action_of(completion_of(argument.value)));
  return fmt::format("      '{}{}[{}]{}' \\\n", argument.is_list ? "*" : "", name,
                     escaped(argument.help), value);
}

/// The line of `_arguments` that completes every positional argument: subcommands, files, streams.
std::string positional_line(const CommandDescription& command) {
  ValueCompletion how;
  for (const ArgumentDescription& argument : command.arguments) {
    if (!argument.is_positional) continue;
    const ValueCompletion one = completion_of(argument.names.front());
    how.files |= one.files;
    how.streams |= one.streams;
    how.words.insert(how.words.end(), one.words.begin(), one.words.end());
  }
  for (const CommandDescription& inner : command.commands) how.words.push_back(inner.name);
  return fmt::format("      '*:argument:{}'\n", action_of(how));
}

std::string case_of(const CommandDescription& command, const std::string& path) {
  std::string text;
  for (const CommandDescription& inner : command.commands) {
    text += case_of(inner, path + " " + inner.name);
  }
  text += fmt::format("    \"{}\") _arguments -s \\\n", path);
  for (const ArgumentDescription& argument : command.arguments) {
    if (argument.is_positional) continue;
    for (const std::string& name : argument.names) text += option_line(argument, name);
  }
  return text + positional_line(command) + "    ;;\n";
}

constexpr std::string_view kZshScript = R"SCRIPT(#compdef splinecast
# zsh completion for splinecast; written by `splinecast completion zsh`.
_splinecast_streams() {
  local -a streams=(${(f)"$(splinecast ls 2>/dev/null | awk 'NR > 1 { print $1 }')"})
  _describe stream streams
}
# Completes with each of the named functions.
_splinecast_any() {
  local one
  for one in "$@"; do $one; done
}
_splinecast() {
  local -a verbs=(
@VERBS@  )
  if ((CURRENT == 2)); then
    _describe verb verbs
    return
  fi
  local verb=$words[2]
  shift words
  ((CURRENT--))
  case "$verb $words[2]" in
    @INNER@)
      if ((CURRENT > 2)); then
        verb+=" $words[2]"
        shift words
        ((CURRENT--))
      fi ;;
  esac
  case "$verb" in
@CASES@  esac
}
if [[ $funcstack[1] == _splinecast ]]; then
  _splinecast "$@"
else
  compdef _splinecast splinecast
fi
)SCRIPT";

}  // namespace

std::string zsh_script(const CommandDescription& program) {
  std::string verbs;
  std::string cases;
  std::vector<std::string> inner;
  for (const CommandDescription& verb : program.commands) {
    verbs += fmt::format("    '{}:{}'\n", verb.name, escaped(verb.summary));
    cases += case_of(verb, verb.name);
    for (const CommandDescription& command : verb.commands) {
      inner.push_back(fmt::format("\"{} {}\"", verb.name, command.name));
    }
  }
  return filled(kZshScript, {{"@VERBS@", verbs},
                             {"@INNER@", fmt::format("{}", fmt::join(inner, "|"))},
                             {"@CASES@", cases}});
}

}  // namespace splinecast::apps
