#pragma once

#include <string_view>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A line on stderr that overwrites itself, where stderr is a terminal; else nothing.
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

/// A message on stderr: `splinecast: …`. What its lines hold of other people's names and texts is
/// printed as ipc::printable() has it.
void say(std::string_view text);

}  // namespace splinecast::apps
