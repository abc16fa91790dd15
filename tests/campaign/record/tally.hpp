#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace splinecast::campaign::record {

/// Counters of one or several runs.
class Tally {
 public:
  Tally();

  /// Counts violations, and prints why. Tally() lists the kinds.
  void find(const std::string& kind, std::uint64_t seed, const std::string& why,
            std::uint64_t count = 1);
  /// Counts work.
  void count(const std::string& what, std::uint64_t count = 1);
  void add(const nlohmann::json& other);

  [[nodiscard]] nlohmann::json to_json() const { return {{"found", found_}, {"work", work_}}; }
  [[nodiscard]] const nlohmann::json& found() const noexcept { return found_; }
  [[nodiscard]] const nlohmann::json& work() const noexcept { return work_; }
  [[nodiscard]] std::uint64_t of(const std::string& what) const;

 private:
  nlohmann::json found_;  ///< violations by kind
  nlohmann::json work_ = nlohmann::json::object();
};

}  // namespace splinecast::campaign::record
