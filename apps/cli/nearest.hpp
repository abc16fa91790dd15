#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace splinecast::apps {

/// The word that differs from a misspelt one by the fewest letters: inserted, removed, replaced, or
/// exchanged with the next one. At most two letters, and less than half of the misspelt word, may
/// differ; otherwise returns no word. Of equally near words returns the first.
[[nodiscard]] std::optional<std::string> nearest(std::string_view misspelt,
                                                 std::span<const std::string> words);

}  // namespace splinecast::apps
