#include "apps/completion/values.hpp"

#include <algorithm>
#include <cctype>

#include "splinecast/method.hpp"

namespace splinecast::apps {
namespace {

/// The names of the methods, as `--method` takes them.
std::vector<std::string> method_words() {
  std::vector<std::string> words;
  for (const Method& method : methods()) words.emplace_back(method.name);
  return words;
}

void add(std::string_view part, ValueCompletion& out) {
  if (part == "FILE" || part == "FILE..." || part == "OUT" || part == "OUT.html" ||
      part == "PREFIX" || part == "A" || part == "B") {
    out.files = true;
  } else if (part == "STREAM" || part == "LAW") {
    out.streams = true;
  } else if (part == "USER") {
    out.users = true;
  } else if (part == "GROUP") {
    out.groups = true;
  } else if (part == "METHOD") {
    out.words = method_words();
  } else if (part == "CONDITION") {
    out.words = {
        "natural", "clamped", "halt", "velocity=", "acceleration=", "not-a-knot", "periodic"};
  } else if (!part.empty() && std::islower(static_cast<unsigned char>(part.front())) != 0) {
    out.words.emplace_back(part);
  }
}

}  // namespace

ValueCompletion completion_of(std::string_view value) {
  ValueCompletion out;
  while (!value.empty()) {
    const std::size_t end = std::min(value.find('|'), value.size());
    add(value.substr(0, end), out);
    value.remove_prefix(std::min(end + 1, value.size()));
  }
  return out;
}

}  // namespace splinecast::apps
