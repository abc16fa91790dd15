#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace splinecast::apps {

/// The word nearest to a misspelt one: at most two letters inserted, removed, replaced, or
/// exchanged with the next one, and fewer than half of the word's. Nothing if there is none. The
/// first of several.
[[nodiscard]] std::optional<std::string> nearest(std::string_view misspelt,
                                                 std::span<const std::string> words);

}  // namespace splinecast::apps
