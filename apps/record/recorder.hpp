#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/record/output/files.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Options of `record`.
struct RecordOptions {
  std::vector<std::string> wanted{};  ///< streams, and patterns of stream names
  OutputOptions output{};
  std::string name{};     ///< for --trigger; empty: none
  std::string trigger{};  ///< a recorder to trigger, instead of recording
  std::optional<Time> duration{};
  bool until_finished = false;
  bool json = false;
  bool quiet = false;
  Trust trust{};
};

/// Records until a stop is requested, which is its normal end, or what the options say. Returns the
/// exit code: kIncomplete if something of a stream is in no file.
int run_record(const RecordOptions& options);

}  // namespace splinecast::apps::record
