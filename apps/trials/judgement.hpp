#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace splinecast::apps {

/// Adds what a check of running streams came to: `judged`, and `sound`, which is null if a stop was
/// requested meanwhile: then it is not judged.
void add_judgement(nlohmann::json& found, bool is_sound);

/// The same for a person: `yes`, `NO` or `not judged: interrupted`.
[[nodiscard]] std::string judgement(const nlohmann::json& found);

/// Runs such a check and prints what it found, as JSON or as `summary` makes it. Returns kOk if it
/// is sound, `unsound` if not, and kInterrupted if it is not judged, also where `run` throws
/// Interrupted.
[[nodiscard]] int print_judgement(const std::function<nlohmann::json()>& run, bool as_json,
                                  std::string (*summary)(const nlohmann::json&), int unsound);

}  // namespace splinecast::apps
