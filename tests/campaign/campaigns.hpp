#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "splinecast/limits.hpp"
#include "tests/campaign/findings.hpp"

/// The campaigns. Each creates its own streams and attacks them, mostly with real processes over
/// real shared memory. It returns its result in the schema of page.py, and whether all promises
/// held.
namespace splinecast::campaign {

struct Result {
  nlohmann::json json;
  bool is_sound = false;
};

struct CampaignOptions {
  std::string command;  ///< repeats the campaign
  std::uint64_t kills = 300;
  std::uint64_t seed = 1;
  double seconds = 2;      ///< stress: of each part; streams and returns: CPU time of the campaign
  std::uint64_t runs = 0;  ///< streams and returns: number of runs, 0: as many as fit into
                           ///< `seconds`; stops: instants at which waypoints end, 0: 200
  std::uint64_t items = 10'000'000;  ///< of a long recording
  std::uint64_t names = 100'000;     ///< of a long recording
  Beyond beyond{};                   ///< motions and returns: of the streams with limits
  std::string trace{};               ///< folder for traces of what readers see; empty: none
};

/// The CPU time that this process has used [s]. It limits campaigns of simulated streams: they then
/// cover the same on a busy machine.
[[nodiscard]] double cpu_seconds() noexcept;

/// Kills processes of two live and two recorded streams, each with two readers, at random instants,
/// until `kills` is reached. `seed` fixes the victims and the instants; the scheduler stays random.
[[nodiscard]] Result run_random_kills(const CampaignOptions& options);

/// Kills both writers and `rm` before every store of each of their steps. Needs a build with hooks.
[[nodiscard]] Result run_every_store(const CampaignOptions& options);

/// One producer and one solver at full speed over the smallest ring and board, and 1, 2, 4, 8 and
/// 16 readers at full speed.
[[nodiscard]] Result run_stress(const CampaignOptions& options);

/// Simulated live streams, one per seed, starting at `seed`. Producer, clock, deaths and delays are
/// random; ring, board, solver and samplers are the real ones in plain memory. If `runs` is 0, the
/// campaign also fails if an event that it must provoke never happened.
[[nodiscard]] Result run_streams(const CampaignOptions& options);

/// Random lives of simulated live streams, one per seed from `seed` on, which end in every way.
/// Checks on every published curve that it ends at rest within limits and bounds, that every item
/// is accounted for, and that the end is the reported one. `seconds` is the CPU time of each of its
/// two threads. If `runs` is 0, or large enough, it also fails if an event that it must provoke
/// never happened.
[[nodiscard]] Result run_ends(const CampaignOptions& options);

/// Random beginnings of live streams in simulated time, 20 of each seed: of streams that exist,
/// that were finished, killed or removed, in motion and at rest. Checks that a controller that
/// follows them makes no step, and that every item is accounted for. `runs` is the number of
/// beginnings.
[[nodiscard]] Result run_starts(const CampaignOptions& options);

/// Random operations on plans, one per seed from `seed` on, without boards. Checks their invariants
/// after each operation, and that each transition between ends of a curve was made. `runs` is the
/// number of plans.
[[nodiscard]] Result run_plans(const CampaignOptions& options);

/// A generated motion with faults of its producer and solver, with and without acceleration limits,
/// in simulated time. Checks that no limit is exceeded and that the curve neither freezes nor
/// jumps. `seed` is the seed of the motion. With `trace`, also writes what readers see around the
/// first fault of each run.
[[nodiscard]] Result run_motions(const CampaignOptions& options);

/// Random faults of motions that keep their limits, one run per seed. Checks that the curve is back
/// on its waypoints in time after the last fault.
[[nodiscard]] Result run_returns(const CampaignOptions& options);

/// Sources that a curve within its limits cannot meet, with Beyond::enter. Checks that no settled
/// segment exceeds a limit, and that a curve which meets no waypoint says so. `runs` is the number
/// of runs of each source, 0: 20.
[[nodiscard]] Result run_follow(const CampaignOptions& options);

/// Stops of live streams whose waypoints end at any millisecond, for each tail and several sources.
/// Checks that no stop speeds up, reverses or travels too far. At some random instants the
/// waypoints really end, and readers must follow the published stop. `seed` is the seed of the
/// motion.
[[nodiscard]] Result run_stops(const CampaignOptions& options);

/// Recorded motions with missing waypoints, checked as in run_motions(). Requires has_recordings().
[[nodiscard]] Result run_recordings(const CampaignOptions& options);

/// Whether recordings exist, in ../shared/data beside the project or in $SPLINECAST_SHARED/data.
[[nodiscard]] bool has_recordings();

/// The faults of run_motions() in real time, with real processes, which are killed where
/// run_motions() simulates a death. Effects that only a late scheduler can cause are reported, but
/// are not findings.
[[nodiscard]] Result run_live_motions(const CampaignOptions& options);

/// Random requests of a time law by 16 commander processes, with its solver killed and stopped and
/// commanders killed, beside a busy loop on every CPU and 5,000 other files in the folder of shared
/// memory. Checks that each request is in force and has its effect, and that the rate never exceeds
/// a bound. `seconds` is its duration.
[[nodiscard]] Result run_requests(const CampaignOptions& options);

/// The same in simulated time, in one process: `runs` requests, with a clock that advances within
/// each step, and takeovers. Also checks that the law comes to rest at the least requested rate.
[[nodiscard]] Result run_simulated_requests(const CampaignOptions& options);

/// Kills a stopper of a live stream, and the solver that hears it, before each of their stores.
/// Needs a build with hooks.
[[nodiscard]] Result run_every_store_of_stops(const CampaignOptions& options);

/// The program `record` beside random streams, in processes of their own, on a disk that can be
/// slow or full, one run per seed from `seed` on. Checks from its files alone that each item and
/// each segment is recorded or lost. `seconds` is the duration, unless `runs` is given.
[[nodiscard]] Result run_recorders(const CampaignOptions& options);

/// One recorder of `names` streams, which come and go, with `items` in all. Prints and measures the
/// memory that it takes.
[[nodiscard]] Result run_long_recording(const CampaignOptions& options);

/// The faults of the motions, one per line: the name of their plots (may be empty), a tab and a
/// description.
[[nodiscard]] std::string list_motions();

/// A result in the schema of page.py, with this machine and version. It is sound if each counter in
/// `found` is 0.
[[nodiscard]] Result make_result(const CampaignOptions& options, nlohmann::json promises,
                                 const std::string& attack, std::uint64_t count,
                                 const std::string& unit, nlohmann::json found,
                                 nlohmann::json measured, double seconds);
[[nodiscard]] Result make_result(const CampaignOptions& options, nlohmann::json promises,
                                 const std::string& attack, std::uint64_t count,
                                 const std::string& unit, const Findings& findings,
                                 nlohmann::json measured, double seconds);

/// This machine as the object `machine` of a result.
[[nodiscard]] nlohmann::json this_machine();

/// Commit, compiler and flags of this build.
[[nodiscard]] std::string this_build();

/// The current date in UTC, as YYYY-MM-DD.
[[nodiscard]] std::string today();

/// A stream name that contains the id of this process.
[[nodiscard]] std::string campaign_stream(const std::string& what);

/// Interval at which a campaign polls its streams; also the resolution of its times.
inline constexpr Time kLook{500'000};

}  // namespace splinecast::campaign
