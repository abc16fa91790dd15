#pragma once

#include <string>

namespace splinecast::apps {

/// The result of a check.
enum class Verdict {
  ok,
  note,     ///< everything works, but something could be better, or should be known
  problem,  ///< something does not work
  unknown,  ///< it is unknown, for the reason given
};

/// A finding of a check, with the fix if there is a problem.
struct Finding {
  std::string check;  ///< what was checked
  Verdict verdict = Verdict::ok;
  std::string means;  ///< what was found, and what it means: one line
  std::string fix{};  ///< how to fix it, one line; empty if there is nothing to fix
};

}  // namespace splinecast::apps
