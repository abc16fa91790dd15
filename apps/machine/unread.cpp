#include "apps/machine/unread.hpp"

#include <fmt/format.h>

namespace splinecast::apps {

std::string unread(const MachineFacts& facts, std::initializer_list<const char*> files) {
  std::string text;
  for (const char* const file : files) {
    const auto found = facts.unread.find(file);
    if (found == facts.unread.end()) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", found->first, found->second);
  }
  return text;
}

Finding unknown(const std::string& check, const std::string& why) {
  return {.check = check, .verdict = Verdict::unknown, .means = why};
}

}  // namespace splinecast::apps
