#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "apps/completion/scripts.hpp"
#include "apps/completion/template.hpp"
#include "apps/completion/values.hpp"

namespace splinecast::apps {
namespace {

/// The command that completes `$word` with a value; empty if nothing does.
std::string reply(const ValueCompletion& how) {
  std::string flags;
  if (how.files) flags += " -f";
  if (how.users) flags += " -u";
  if (how.groups) flags += " -g";
  std::vector<std::string> words = how.words;
  if (how.streams) words.emplace_back("$(_splinecast_streams)");
  if (!words.empty()) flags += fmt::format(" -W \"{}\"", fmt::join(words, " "));
  return flags.empty() ? flags : fmt::format("_splinecast_reply{}", flags);
}

/// The cases of the options with a value: `"fit --at") …`.
std::string value_cases(const CommandDescription& command, const std::string& path) {
  std::string text;
  for (const ArgumentDescription& argument : command.arguments) {
    if (argument.is_positional || argument.value.empty()) continue;
    const std::string how = reply(completion_of(argument.value));
    for (const std::string& name : argument.names) {
      text += fmt::format("    \"{} {}\") {}; return ;;\n", path, name, how.empty() ? ":" : how);
    }
  }
  for (const CommandDescription& inner : command.commands) {
    text += value_cases(inner, path + " " + inner.name);
  }
  return text;
}

/// The case of a command: its options, its subcommands and what its positional arguments are.
std::string word_cases(const CommandDescription& command, const std::string& path) {
  std::vector<std::string> options;
  ValueCompletion positional;
  for (const ArgumentDescription& argument : command.arguments) {
    if (argument.is_positional) {
      const ValueCompletion one = completion_of(argument.names.front());
      positional.files |= one.files;
      positional.streams |= one.streams;
      positional.words.insert(positional.words.end(), one.words.begin(), one.words.end());
    } else {
      options.insert(options.end(), argument.names.begin(), argument.names.end());
    }
  }
  std::string text;
  for (const CommandDescription& inner : command.commands) {
    text += word_cases(inner, path + " " + inner.name);
    positional.words.push_back(inner.name);
  }
  const std::string how = reply(positional);
  text += fmt::format("    \"{}\") [[ $word == -* ]] && _splinecast_reply -W \"{}\" || {} ;;\n",
                      path, fmt::join(options, " "), how.empty() ? ":" : how);
  return text;
}

/// The paths of the commands that have subcommands of their own: `"latency compare"`.
std::string inner_paths(const CommandDescription& program) {
  std::vector<std::string> paths;
  for (const CommandDescription& verb : program.commands) {
    for (const CommandDescription& inner : verb.commands) {
      paths.push_back(fmt::format("\"{} {}\"", verb.name, inner.name));
    }
  }
  return fmt::format("{}", fmt::join(paths, "|"));
}

constexpr std::string_view kBashScript =
    R"SCRIPT(# bash completion for splinecast; written by `splinecast completion bash`.
_splinecast_streams() { splinecast ls 2>/dev/null | awk 'NR > 1 { print $1 }'; }
_splinecast_reply() { mapfile -t COMPREPLY < <(compgen "$@" -- "$word"); }
_splinecast() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local verb=${COMP_WORDS[1]}
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    _splinecast_reply -W "@VERBS@ --help --version"
    return
  fi
  case "$verb ${COMP_WORDS[2]}" in
    @INNER@) ((COMP_CWORD > 2)) && verb+=" ${COMP_WORDS[2]}" ;;
  esac
  case "$verb $before" in
@VALUES@  esac
  case "$verb" in
@WORDS@  esac
}
complete -o bashdefault -o filenames -F _splinecast splinecast
)SCRIPT";

}  // namespace

std::string bash_script(const CommandDescription& program) {
  std::vector<std::string> verbs;
  std::string values;
  std::string words;
  for (const CommandDescription& verb : program.commands) {
    verbs.push_back(verb.name);
    values += value_cases(verb, verb.name);
    words += word_cases(verb, verb.name);
  }
  return filled(kBashScript, {{"@VERBS@", fmt::format("{}", fmt::join(verbs, " "))},
                              {"@INNER@", inner_paths(program)},
                              {"@VALUES@", values},
                              {"@WORDS@", words}});
}

}  // namespace splinecast::apps
