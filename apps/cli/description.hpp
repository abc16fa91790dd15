#pragma once

#include <string>
#include <vector>

namespace splinecast::apps {

/// An option, a flag or a positional argument, as the help shows it.
struct ArgumentDescription {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional argument "FILE"
  std::string value;  ///< name of its value, such as MS or live|recorded; a flag: empty
  std::string help;
  bool is_positional = false;
  bool is_required = false;
  bool is_list = false;  ///< takes several values
};

/// A command: the program, a verb, or a subcommand of a verb.
struct CommandDescription {
  std::string name;
  std::string summary;
  std::vector<ArgumentDescription> arguments{};  ///< in the order of the help
  std::vector<CommandDescription> commands{};
};

}  // namespace splinecast::apps
