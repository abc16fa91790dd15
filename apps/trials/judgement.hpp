#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace splinecast::apps {

/// Adds the result of a check of running streams: `judged`, false if a stop was requested, and
/// `sound`, which is then null.
void add_judgement(nlohmann::json& found, bool is_sound);

/// The result as text: `yes`, `NO` or `not judged: interrupted`.
[[nodiscard]] std::string judgement(const nlohmann::json& found);

/// Runs a check and prints its result, as JSON or as text from `summary`. Returns kOk if it is
/// sound, `unsound` if not, and kInterrupted if it is not judged or `run` throws Interrupted.
[[nodiscard]] int print_judgement(const std::function<nlohmann::json()>& run, bool as_json,
                                  std::string (*summary)(const nlohmann::json&), int unsound);

}  // namespace splinecast::apps
