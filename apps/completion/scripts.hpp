#pragma once

#include <string>

#include "apps/cli/description.hpp"

namespace splinecast::apps {

/// A script that completes the program's command line: verbs, options, and values. Source it in
/// bash, or put it into a folder of bash-completion under the program's name.
[[nodiscard]] std::string bash_script(const CommandDescription& program);

/// The same for zsh: put it into a folder of `fpath` as `_splinecast`.
[[nodiscard]] std::string zsh_script(const CommandDescription& program);

/// All commands and arguments as JSON.
[[nodiscard]] std::string json_text(const CommandDescription& program);

}  // namespace splinecast::apps
