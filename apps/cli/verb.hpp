#pragma once

#include <functional>

#include "apps/cli/command.hpp"

namespace splinecast::apps {

/// What a verb runs once its arguments are parsed. Returns the exit code.
using Action = std::function<int()>;

/// A verb of the program. A constant of this type enters itself into the program's list before
/// `main` begins, so that a verb is one file: nothing else names it. Lives as long as the program.
class Verb {
 public:
  /// Adds the verb's options to `verb`, and sets `action` when that verb is chosen.
  using Add = void (*)(Command& verb, Action& action);

  /// `place` says where the help lists it: each verb has one of its own.
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
