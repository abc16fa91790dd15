#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/time.hpp"

/// The campaign `record`: the program `splinecast record` beside streams that come, go and send as
/// fast as they can, on a disk that fails.
namespace splinecast::campaign::record {

/// What happens to the recorder in a run. Streams come and go in each of them.
enum class Attack : std::uint8_t {
  none,
  paused,       ///< SIGSTOP for 0.2 to 3 s
  slow,         ///< the disk writes about 1 MB/s at times
  full,         ///< the disk is full for 0.2 to 1.5 s
  full_at_end,  ///< the disk is full, and remains so
  killed,       ///< SIGKILL
  interrupted,  ///< SIGINT before the streams end, sometimes paused or with a slow or full disk
  dumps,        ///< --last, with events and triggers
  rotated,      ///< --max-size and triggers: several files, one after the other
  renamed,      ///< the file gets another name
  flooded,      ///< the disk does not answer, until the queue of the recorder is full
};
inline constexpr std::size_t kAttacks = 11;
[[nodiscard]] std::string_view to_string(Attack attack) noexcept;

/// How a stream is sent.
enum class SourceKind : std::uint8_t {
  live,      ///< waypoints of the near future, replacements and stops
  follower,  ///< the same by the time of a law
  fast,      ///< recorded times, as fast as possible: overwrites a small ring
  unsolved,  ///< no solver
  wide,      ///< fast, with 64 dimensions and a large ring
};

/// A process that creates a stream again and again.
struct SourcePlan {
  std::string stream{};
  SourceKind kind{};
  std::string law{};  ///< of a follower
  std::uint64_t seed = 0;
  Time length{};  ///< of the process
};

/// The end of the name of a law.
inline constexpr std::string_view kLawName = ".law";

struct RunPlan {
  std::uint64_t seed = 0;
  Attack attack{};
  std::string prefix{};  ///< of the names of streams
  std::vector<SourcePlan> sources{};
  std::string law{};                   ///< empty: none
  bool is_late = false;                ///< the recorder starts after the streams
  std::vector<std::string> options{};  ///< of the recorder
};

/// The run of a seed: each eleven consecutive seeds have each attack once.
[[nodiscard]] RunPlan make_plan(std::uint64_t seed);

}  // namespace splinecast::campaign::record
