#include <array>
#include <charconv>

#include "splinecast/producer.hpp"

namespace splinecast {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6);
  return {text.begin(), end.ptr};
}

}  // namespace

std::string to_string(const ItemRefusal& refusal) {
  std::string text = "item " + std::to_string(refusal.item) + " refused: ";
  text += to_string(refusal.reason);
  if (refusal.time) text += " (time " + std::to_string(refusal.time->count()) + " ns)";
  if (refusal.excess) text += ": " + in_words(*refusal.excess);
  return text;
}

std::string in_words(const LimitExcess& excess, std::span<const std::string> names) {
  std::string text(to_string(excess.kind));
  text += " of dimension " + std::to_string(excess.dimension);
  const bool has_name = excess.dimension < names.size() && !names[excess.dimension].empty();
  if (has_name) text += " (" + names[excess.dimension] + ")";
  return text + " is " + number(excess.value) + " at " + std::to_string(excess.time.count()) +
         " ns, limit " + number(excess.limit);
}

}  // namespace splinecast
