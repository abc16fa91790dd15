#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/campaign/motions/ended.hpp"
#include "tests/campaign/motions/schedule.hpp"
#include "tests/campaign/motions/sines.hpp"
#include "tests/campaign/motions/trial.hpp"

namespace splinecast::campaign {

/// Writes what a reader sees around the first fault of each schedule, or around its end, for
/// docs/plots.py: a file `NAME.csv` per row, and `rows.json`, which describes each of them. Uses
/// simulated time without noise, so the files are the same on every machine.
class Traces {
 public:
  /// Creates the folder if it is missing.
  explicit Traces(std::filesystem::path folder);

  /// Runs a row and writes its file. `limit` is in rad/s²; 0: none.
  void add(const Sines& motion, const Fault& fault, double limit, TrialOptions options);

  /// The same for the end of a stream.
  void add(const Sines& motion, const Ended& ended, double limit, TrialOptions options);

  /// Writes `rows.json`.
  void finish() const;

 private:
  std::filesystem::path folder_;
  nlohmann::json rows_;
};

}  // namespace splinecast::campaign
