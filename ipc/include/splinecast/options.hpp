#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/method.hpp"
#include "splinecast/time.hpp"

/// Options of a stream's roles: structs of values with defaults. The role that takes them checks
/// them and throws BadRequest for a value out of range.
namespace [[gnu::visibility("default")]] splinecast {

/// The owners whose regions this process uses: its own user, root, and `owner` if set. A region
/// must also be a regular file that neither its group nor others may write.
struct Trust {
  std::optional<uid_t> owner{};
};

/// Access to the regions that this process creates.
struct RegionAccess {
  mode_t mode = 0600;            ///< permission bits; only the owner ever writes
  std::optional<gid_t> group{};  ///< group of the regions; unset: this process's
};

/// The interval allowed between two consecutive waypoints.
struct IngestLimits {
  Time min_interval{1'000};              ///< 1 ns or more; default 1 µs
  Time max_interval{3'600'000'000'000};  ///< min_interval or more, below 2⁶¹ ns;
                                         ///< default 1 h
};

/// The properties of a stream, which its producer sets.
struct ProducerOptions {
  std::size_t dimensions = 1;        ///< 1 to 64
  std::vector<std::string> names{};  ///< one per dimension, or none; each is cut to at most 31
                                     ///< bytes, at the end of a UTF-8 character
  std::vector<std::string> units{};  ///< the same, cut to 15 bytes
  std::vector<Dimension> kinds{};    ///< one per dimension, or none: all linear
  StreamClock clock = StreamClock::monotonic;
  std::string law{};  ///< time law that the stream follows, with `clock` law: times of waypoints
                      ///< are then its stream time
  Condition start{.kind = ConditionKind::halt, .value = {}};  ///< one for which is_online() holds
  IngestLimits limits{};
  Time horizon{3'600'000'000'000};  ///< of a live stream without a law: how far ahead of now a time
                                    ///< may be; above 0; default 1 h; max(): no time is compared
                                    ///< with now, for a simulated clock
  double start_tolerance = 0.001;   ///< of a live stream: see Producer::append; in the dimension's
                                    ///< unit, rad for a quaternion; 0 or more; default 0.001
  std::size_t capacity = 1024;      ///< ring items, 2 to 2²⁴; default 1,024; rounded up to a
                                    ///< power of two
  RegionAccess access{};
  Trust trust{};
};

/// The properties of a curve, which its solver sets. On a new board, unset members take their
/// defaults. A solver that takes over a board uses the board's options; members that are set must
/// not contradict these.
struct SolverOptions {
  const Method* method = nullptr;        ///< default c2; streams() must hold
  std::optional<double> lambda{};        ///< of smoothing, which needs it: λ, 0 to 1e100 s³
  std::optional<double> time_scale{};    ///< of rounded: above 0, at most 1e100 s; default 1 s
  std::optional<std::size_t> settle{};   ///< settle lag K, 0 to 64; default 8 for c2, 64 for
                                         ///< smoothing, else the look-ahead of the method, which is
                                         ///< its least. Smoothing: 13 or more unless force_lag
  std::optional<Tail> tail{};            ///< default bessel; not for a method with its own tail
  bool force_lag = false;                ///< of smoothing: accept a lag that is too short for λ
  std::optional<Time> stop_time{};       ///< length of the stop segment; with a limit of
                                         ///< acceleration or jerk, its least length. Above 0, at
                                         ///< most 2⁶⁰ ns; default 250 ms
  std::optional<MotionLimits> limits{};  ///< lists of one value per dimension, or one for all
  std::vector<NamedLimits> named_limits{};  ///< by dimension name, for the kinds of limit of which
                                            ///< `limits` has no list; unknown names have no effect
  std::optional<Beyond> beyond{};           ///< default report
  std::optional<Time> freeze_ahead{};       ///< live: the curve settles this long ahead of now;
                                            ///< 1 ns to 1 min; default 5 ms
  std::optional<Time> history{};            ///< live: segments that ended less than this ago are
                                            ///< kept; 0 to 24 h; default 1 s
  std::optional<Time> min_entry{};          ///< live: least length of an entry; 1 ns to 1 min;
                                            ///< default freeze_ahead
  std::optional<double> largest_rate{};     ///< of a time law: above 0, at most 100; default 1
  std::optional<std::size_t> capacity{};    ///< segments of history, 2(K + 6) + 2 to 2²²; default
                                            ///< 4,096; rounded up to a power of two
  bool wake = true;  ///< wake waiting readers: one system call per revision, which wakes at most
                     ///< eight threads
  RegionAccess access{};
  Trust trust{};
};

}  // namespace splinecast
