#pragma once

#include <string>

namespace splinecast::apps {

/// How a check came out.
enum class Verdict {
  ok,
  note,     ///< everything works, but something could be better, or should be known
  problem,  ///< something does not work
  unknown,  ///< it cannot be known, for the reason given
};

/// What a check found.
struct Finding {
  std::string check;  ///< what was looked at
  Verdict verdict = Verdict::ok;
  std::string means;   ///< what was found, and what it means: one line
  std::string mend{};  ///< how to mend it, one line; empty where there is nothing to mend
};

}  // namespace splinecast::apps
