#include "apps/cli/verb.hpp"

#include <algorithm>
#include <vector>

namespace splinecast::apps {
namespace {

/// The first verb of the list. Constant-initialised: valid before any verb is constructed.
constinit const Verb* first_verb = nullptr;

}  // namespace

Verb::Verb(const char* name, int place, const char* summary, Add add) noexcept
    : name_(name), place_(place), summary_(summary), add_(add), next_(first_verb) {
  first_verb = this;
}

void Verb::add_all(Command& program, Action& action) {
  std::vector<const Verb*> verbs;
  for (const Verb* verb = first_verb; verb != nullptr; verb = verb->next_) verbs.push_back(verb);
  std::ranges::sort(verbs, {}, &Verb::place_);
  for (const Verb* const verb : verbs) {
    Command command = program.subcommand(verb->name_, verb->summary_);
    verb->add_(command, action);
  }
}

}  // namespace splinecast::apps
