#include "apps/cli/nearest.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace splinecast::apps {
namespace {

/// The number of letters to insert, remove, replace, or exchange with the next one.
std::size_t distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
    return table[i * width + j];
  };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({replaced, at(i - 1, j) + 1, at(i, j - 1) + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return at(a.size(), b.size());
}

}  // namespace

std::optional<std::string> nearest(std::string_view misspelt, std::span<const std::string> words) {
  constexpr std::size_t kMost = 2;
  constexpr std::size_t kLongest = 64;  // bounds the work
  if (misspelt.empty() || misspelt.size() > kLongest) return std::nullopt;
  std::size_t least = std::min(kMost, (misspelt.size() - 1) / 2) + 1;
  std::optional<std::string> found;
  for (const std::string& word : words) {
    const std::size_t letters = distance(misspelt, word);
    if (letters >= least) continue;
    least = letters;
    found = word;
  }
  return found;
}

}  // namespace splinecast::apps
