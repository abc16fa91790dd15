#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/campaign/findings.hpp"

/// The campaigns: each attacks streams of its own, mostly with real processes over real shared
/// memory, and returns its result, as the head of page.py says, and whether no promise was broken.
namespace splinecast::campaign {

struct Result {
  nlohmann::json json;
  bool is_sound = false;
};

struct CampaignOptions {
  std::string command;  ///< that runs it again
  std::uint64_t kills = 300;
  std::uint64_t seed = 1;
  double seconds = 2;      ///< of each part of the stress; of the streams all of them
  std::uint64_t runs = 0;  ///< of simulated streams, 0: as many as the seconds allow; of instants
                           ///< at which encoders end, 0: 200
  std::string trace{};     ///< folder for what readers of the motions see; empty: none
};

/// Kills at random instants until there were so many kills: two live streams and two recorded ones,
/// each with two readers. `seed` fixes whom and when, as far as a schedule can be fixed.
[[nodiscard]] Result run_random_kills(const CampaignOptions& options);

/// Kills before every single store of every step of both writers and of `rm`. Needs a build with
/// hooks.
[[nodiscard]] Result run_every_store(const CampaignOptions& options);

/// One producer and one solver as fast as they go over the smallest ring and board, and 1, 2, 4, 8
/// and 16 readers that read all they can.
[[nodiscard]] Result run_stress(const CampaignOptions& options);

/// Simulated live streams, one per seed from `seed` on: producer, clock, deaths and hold-ups are
/// random, ring, board, solver and samplers the real ones in plain memory. Without a number of runs
/// it fails as well if something of what it is to try never happened.
[[nodiscard]] Result run_streams(const CampaignOptions& options);

/// A generated motion whose producer and solver meet mishaps, with limits of acceleration and
/// without, in simulated time: no limit passed, no freeze, no jump. `seed` is that of the motion.
/// With `trace`, also writes what readers see around the first mishap of each.
[[nodiscard]] Result run_motions(const CampaignOptions& options);

/// Random mishaps of motions that keep their limits, one run per seed, and then none any more: the
/// curve is back on its waypoints in time.
[[nodiscard]] Result run_returns(const CampaignOptions& options);

/// The stops of live waypoints that end at any millisecond, for each tail and several sources: none
/// speeds up, turns round or goes too far. At some random instants the waypoints really end, and
/// readers must go down what was published. `seed` is that of the motion.
[[nodiscard]] Result run_stops(const CampaignOptions& options);

/// Recorded motions from which waypoints are missing, as run_motions. Needs `has_recordings`.
[[nodiscard]] Result run_recordings(const CampaignOptions& options);

/// Whether there are any: in ../shared/data beside the project, or in $SPLINECAST_SHARED/data.
[[nodiscard]] bool has_recordings();

/// The mishaps of run_motions in real time, with processes that are killed where it lets them die.
/// What can only come of a machine that does not run them in time is told, but is no finding.
[[nodiscard]] Result run_live_motions(const CampaignOptions& options);

/// The mishaps of the motions, a line each: the name of their plots, if there are, and
/// what happens.
[[nodiscard]] std::string list_motions();

/// A result in the form of the page, of this machine and version. It is sound if all that was found
/// is 0.
[[nodiscard]] Result make_result(const CampaignOptions& options, nlohmann::json promises,
                                 const std::string& attack, std::uint64_t count,
                                 const std::string& unit, nlohmann::json found,
                                 nlohmann::json measured, double seconds);
[[nodiscard]] Result make_result(const CampaignOptions& options, nlohmann::json promises,
                                 const std::string& attack, std::uint64_t count,
                                 const std::string& unit, const Findings& findings,
                                 nlohmann::json measured, double seconds);

/// What a result says of this machine.
[[nodiscard]] nlohmann::json this_machine();

/// What was built and how: commit, compiler, flags.
[[nodiscard]] std::string this_build();

/// A stream name of this process.
[[nodiscard]] std::string campaign_stream(const std::string& what);

/// Between two looks at all streams of a campaign, and so the resolution of its times.
inline constexpr Time kLook{500'000};

}  // namespace splinecast::campaign
