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

/// What the roles of a stream are told: structs of values with their defaults. The role that takes
/// them checks them, and throws BadRequest for a value out of its range.
namespace [[gnu::visibility("default")]] splinecast {

/// Whose regions this process uses: its own user's and root's, and those of `owner` if set. A
/// region must also be a regular file that neither its group nor others may write.
struct Trust {
  std::optional<uid_t> owner{};
};

/// Who may use the regions that this process makes.
struct RegionAccess {
  mode_t mode = 0600;            ///< permission bits; nobody but the owner ever writes
  std::optional<gid_t> group{};  ///< group to give it to; unset: this process's
};

/// The checks that a waypoint must pass, wherever it comes from.
struct IngestLimits {
  Time min_interval{1'000};              ///< at least 1 ns; default 1 µs
  Time max_interval{3'600'000'000'000};  ///< min_interval or more, below 2⁶¹ ns; default 1 h
};

/// What a producer fixes about its stream.
struct ProducerOptions {
  std::size_t dimensions = 1;        ///< 1 to 64
  std::vector<std::string> names{};  ///< one per dimension, or none; each is cut to at most 31
                                     ///< bytes, between characters of UTF-8
  std::vector<std::string> units{};  ///< likewise, to 15 bytes
  std::vector<Dimension> kinds{};    ///< one per dimension, or none: all linear
  StreamClock clock = StreamClock::monotonic;
  Condition start{.kind = ConditionKind::halt, .value = {}};  ///< one for which is_online() holds
  IngestLimits limits{};
  std::size_t capacity = 1024;  ///< ring items, 2 to 2²⁴; rounded up to a power of two
  RegionAccess access{};
  Trust trust{};
};

/// What a solver fixes about its curve. What is unset takes its default on a new board; a solver
/// that takes a board over takes its options too, and may not contradict them.
struct SolverOptions {
  const Method* method = nullptr;        ///< default c2; one that streams
  std::optional<double> lambda{};        ///< of smoothing, which needs it: λ, 0 to 1e100, in s³
  std::optional<double> time_scale{};    ///< of rounded: above 0, at most 1e100 s; default 1 s
  std::optional<std::size_t> settle{};   ///< settle lag K, at most 64: from 0 for `c2`, default
                                         ///< 8; from 13 for smoothing, unless force_lag,
                                         ///< default 64; else from what the method looks ahead,
                                         ///< which is the default
  std::optional<Tail> tail{};            ///< default bessel; not for a method with one of its own
  bool force_lag = false;                ///< of smoothing: take a lag that is too short for λ
  std::optional<Time> stop_time{};       ///< length of the stop segment; with a limit of
                                         ///< acceleration or jerk its least length. Above 0, at
                                         ///< most 2⁶⁰ ns; default 250 ms
  std::optional<MotionLimits> limits{};  ///< lists of one value per dimension or one for all
  std::vector<NamedLimits> named_limits{};  ///< of dimensions by name, where `limits` has none
                                            ///< of the kind; other names are of no effect
  std::optional<Beyond> beyond{};           ///< default report
  std::optional<Time> freeze_ahead{};       ///< live: what lies this long ahead settles; 1 ns to
                                            ///< 1 min, default 5 ms
  std::optional<Time> history{};            ///< live: what ended less than this ago is kept; 0 to
                                            ///< 24 h, default 1 s
  std::optional<Time> min_splice{};         ///< live: least length of an entry; 1 ns to 1 min,
                                            ///< default as freeze_ahead
  std::optional<std::size_t> capacity{};    ///< segments of history, 2(K + 6) + 2 to 2²²; rounded
                                            ///< up to a power of two, default 4,096
  bool wake = true;  ///< wake waiting readers: one system call a revision, which wakes
                     ///< at most eight threads
  RegionAccess access{};
  Trust trust{};
};

}  // namespace splinecast
