#pragma once

#include <string>
#include <string_view>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A progress line on stderr that overwrites itself. Prints nothing if stderr is not a terminal.
class Progress {
 public:
  Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows the text, at most ten times a second.
  void show(std::string_view text);

 private:
  bool terminal_;
  bool shown_ = false;
  Time next_{};
};

/// A text from a file, for a message: control characters, escape sequences and invalid UTF-8 are
/// escaped as in ipc::printable(), and a text of more than 60 bytes is cut and ends with `…`.
[[nodiscard]] std::string shown(std::string_view text);

/// Prints a message on stderr: `splinecast: …`. Passes each line through ipc::printable(), because
/// it may contain names and texts of other users.
void say(std::string_view text);

}  // namespace splinecast::apps
