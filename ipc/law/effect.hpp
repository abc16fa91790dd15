#pragma once

#include <string>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

/// What a ramp of a time law will make of the motions that follow the law.
namespace splinecast::ipc {

/// The largest magnitudes along the published future of one stream, one value per dimension, and
/// the place nearest to a limit of the stream.
struct RampEffect {
  std::string stream;
  std::vector<std::string> names;    ///< of the dimensions
  std::vector<double> velocity;      ///< [unit/s]
  std::vector<double> acceleration;  ///< [unit/s²]
  std::vector<double> jerk;          ///< [unit/s³]
  Excess worst{};  ///< its ratio is above 1 beyond a limit, below 0 without limits
};

/// The names of the streams whose board follows the law with this stream id. Streams that cannot be
/// read are left out. System calls; allocates.
[[nodiscard]] std::vector<std::string> followers_of(std::uint64_t law_id, const Trust& trust);

/// Follows a rate from the state `from` on, over what the stream has published, for at most
/// `longest` of host time; samples every millisecond. `origin` is that of the law. Throws as Reader
/// does.
[[nodiscard]] RampEffect effect_of(const std::string& stream, const core::LawState& from,
                                   const core::RateCurve& rate, Time origin, Time longest,
                                   const Trust& trust);

}  // namespace splinecast::ipc
