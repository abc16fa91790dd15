#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace splinecast::apps {

/// What completes a value of an option or of a positional argument.
struct ValueCompletion {
  std::vector<std::string> words{};  ///< words to choose from; the value need not be one of them
  bool files = false;
  bool streams = false;  ///< names of the streams of this host
  bool users = false;
  bool groups = false;
};

/// The completion of a value with this name in the help: "live|recorded" is one of two words, FILE
/// a path, STREAM a stream. Numbers have none.
[[nodiscard]] ValueCompletion completion_of(std::string_view value);

}  // namespace splinecast::apps
