#pragma once

#include <functional>

#include "apps/cli/command.hpp"

namespace splinecast::apps {

/// The function of a verb, run after its arguments are parsed. Returns the exit code.
using Action = std::function<int()>;

/// A verb of the program. A constant of this type registers itself in the program's list before
/// `main` starts, so that a verb is one source file, which no other file mentions. It must exist as
/// long as the program runs.
class Verb {
 public:
  /// Adds the verb's options to `verb`, and sets `action` when that verb is chosen.
  using Add = void (*)(Command& verb, Action& action);

  /// `place` orders the verbs in the help. Each verb has a unique place.
  Verb(const char* name, int place, const char* summary, Add add) noexcept;

  /// Adds every verb to the program, in the order of their places.
  static void add_all(Command& program, Action& action);

 private:
  const char* name_;
  int place_;
  const char* summary_;
  Add add_;
  const Verb* next_;  ///< in the list
};

}  // namespace splinecast::apps
