#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/recordings/advice.hpp"

namespace splinecast::apps {

/// The source of advice: a file, or a stream with its options and its solver's counters.
struct AdviceSource {
  std::string name;
  std::vector<std::string> columns;  ///< names, with units in brackets
  std::size_t rows = 0;
  Time length{};
  std::size_t duplicates = 0;
  std::size_t out_of_order = 0;

  /// Options and counters of a stream that a solver has attached to.
  struct Solved {
    SolvedHow how{};
    Time stop_length{};
    std::optional<Time> low_water{};  ///< least depth so far
    std::size_t deadline_misses = 0;  ///< revisions discarded because they were too late
    std::size_t late_commits = 0;     ///< revisions committed although they were too late

    [[nodiscard]] bool was_late() const { return deadline_misses + late_commits > 0; }
  };
  std::optional<Solved> solved{};
};

/// Advice as JSON and as text, with reasons.
[[nodiscard]] nlohmann::ordered_json to_json(const Advice& advice, const AdviceSource& source);
[[nodiscard]] std::string in_words(const Advice& advice, const AdviceSource& source);

/// The reason for the lead of advised_lead.
[[nodiscard]] std::string lead_in_words(const Intervals& intervals, const SolvedHow& how,
                                        Time lead);

/// The effect of a silence of the producer, as text.
[[nodiscard]] std::string in_words(const SilenceEffect& silence);

/// A time in milliseconds, with its unit.
[[nodiscard]] std::string in_milliseconds(Time t);

}  // namespace splinecast::apps
