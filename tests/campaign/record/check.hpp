#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/campaign/record/contents.hpp"
#include "tests/campaign/record/plan.hpp"
#include "tests/campaign/record/program.hpp"
#include "tests/campaign/record/source.hpp"
#include "tests/campaign/record/tally.hpp"

namespace splinecast::campaign::record {

/// What there is after a run.
struct Remains {
  std::vector<Sent> sent{};
  std::optional<int> code{};  ///< of the recorder
  nlohmann::json report{};    ///< of the recorder; null if it was killed
  bool was_killed = false;    ///< the recorder
  bool is_complete = true;    ///< the recorder was there until everything had been sent
  bool could_write = true;    ///< there was a disk at the end
};

/// Checks the files of a run: each item and each segment is recorded or lost, as the accounts, the
/// report, the exit code and the senders say; and each file verifies.
class RunCheck {
 public:
  RunCheck(const RunPlan& plan, const Remains& remains, const Folder& folder, Tally& tally)
      : plan_(plan), remains_(remains), folder_(folder), tally_(tally) {}

  void run();

 private:
  /// Whether the files have everything that the recorder has read.
  [[nodiscard]] bool has_all() const noexcept {
    return !remains_.was_killed && plan_.attack != Attack::dumps && remains_.could_write;
  }
  void find(const std::string& kind, const std::string& why, std::uint64_t count = 1) const {
    tally_.find(kind, plan_.seed, why, count);
  }

  void check_file(const std::string& path);
  void check_verification(const std::string& path, const FileContents& contents);
  void check_recovered(const std::string& path, const nlohmann::json& streams);
  void check_stream(const std::string& what, const StreamContents& stream, const Sent* sent);
  void check_sent(const std::string& what, const StreamContents& stream, const Sent& sent);
  void check_numbers(const std::string& what, const std::string& unit, const Numbers& numbers,
                     const apps::record::Account::Numbers& account, std::uint64_t lost);
  void check_gaps(const std::string& what, const std::string& unit, const Numbers& numbers,
                  std::optional<std::uint64_t> end);
  void check_left();
  void check_report();
  void count_work();

  const RunPlan& plan_;
  const Remains& remains_;
  const Folder& folder_;
  Tally& tally_;
  Streams streams_;
};

}  // namespace splinecast::campaign::record
