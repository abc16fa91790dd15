#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "core/laws/motion.hpp"
#include "core/laws/rate_curve.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The header of the board of a time law. Throws NoSuchStream if there is none.
[[nodiscard]] RegionHeader header_of_law(const std::string& law, const Trust& trust);

/// A time law at one instant of host time.
struct LawPoint {
  Time stream{};  ///< stream time, rounded down to nanoseconds
  core::LawRates rates{};
  double fraction = 0;  ///< stream time after that, 0 to 1e-9 [s]
};

/// As std::clamp, without branches: a value that is a bound but for rounding would mispredict them.
[[nodiscard]] inline double within(double least, double value, double most) noexcept {
  const double above = least < value ? value : least;
  return above < most ? above : most;
}

/// The point at which a law has this value, in seconds since its origin.
[[nodiscard]] inline LawPoint point_at(double seconds, Time origin,
                                       const core::LawRates& rates) noexcept {
  constexpr double kNanosecond = 1e-9;
  // A board of another process may hold any value.
  constexpr double kMost = 4e9;
  const double bounded = within(0, seconds, kMost);  // a law begins at 0 and never decreases
  const auto whole = static_cast<Time::rep>(bounded * 1e9);
  const double fraction = bounded - static_cast<double>(whole) * kNanosecond;
  return {.stream = saturated_sum(origin, Time(whole)),
          .rates = rates,
          .fraction = within(0, fraction, kNanosecond)};
}

/// The point at which a law's curve has these values. Rounding may exceed the bounds that the ramps
/// respect.
[[nodiscard]] inline LawPoint point_of(const RegionHeader& law, double seconds,
                                       core::LawRates rates) noexcept {
  rates.rate = within(0, rates.rate, max_rate(law));
  return point_at(seconds, Time(law.law_origin), rates);
}

/// The state of a law's curve at a host time, from a sampler of its board; nothing if it cannot be
/// read. `scratch` has one dimension.
[[nodiscard]] std::optional<core::LawState> law_state_at(Sampler& sampler, Time host,
                                                         double max_rate, State& scratch) noexcept;

/// The time law of a stream, as its readers, its solver and its producer follow it: maps host time
/// to stream time. Maps the law's board read-only. When the law is removed, its last curve is
/// followed further: it continues at its last rate. Wait-free; allocates only when constructed. One
/// thread uses it.
class LawFollower {
 public:
  /// Follows the law that a stream's header names. Throws NoSuchStream if the law has no board yet;
  /// LawLost if it has been removed, also if another stream has its name now; BadRegion if the
  /// board cannot be used or is not that of a law.
  LawFollower(const RegionHeader& stream, const Trust& trust);
  /// Follows the law of this name, with any id. Throws as above.
  LawFollower(const std::string& law, const Trust& trust);
  LawFollower(const LawFollower&) = delete;
  LawFollower& operator=(const LawFollower&) = delete;
  ~LawFollower() = default;

  /// The law at a host time, as executed: see Sampler::sample. Without values, `out` is unchanged.
  [[nodiscard]] SampleStatus at(Time host, LawPoint& out) noexcept;
  /// The same for readers, which do not use last().
  [[nodiscard]] SampleStatus look_up(Time host, bool is_executed, LawPoint& out) noexcept {
    Sampler::Place place;
    const bool is_in_current = sampler_.find_current(host, is_executed, place);
    if (!is_in_current || place.order != kMaxOrder) return sample(host, is_executed, out);
    const auto [s, rate, slope, curvature] = core::evaluate_one(place.coefficients.data(), place.u);
    out = point_of(board_.header, s, {.rate = rate, .slope = slope, .curvature = curvature});
    return place.status;
  }
  /// The same for a time ahead: see Sampler::preview.
  [[nodiscard]] SampleStatus ahead(Time host, LawPoint& out) noexcept {
    return convert(sampler_.preview(host, state_.ref()), out);
  }

  /// The state of the law's curve at a host time, for a time ahead; nothing if it cannot be read.
  [[nodiscard]] std::optional<core::LawState> state_at(Time host) noexcept;

  [[nodiscard]] const RegionHeader& header() const noexcept { return board_.header; }

  /// The law never changes before this host time, as the last call saw it.
  [[nodiscard]] Time settled_until() const noexcept { return sampler_.settled_until(); }

  /// The stream time before which no stream of the law changes any more: 1 ns after the time that
  /// the law's settled part has reached, or that it has at `host`, a host time that has passed. A
  /// stream's settled word may be later: while the law holds, that word can go back to this time.
  /// Read this before the word. min() if the law cannot be read.
  [[nodiscard]] Time final_until(Time host) noexcept;

  /// The revision that the last call saw.
  [[nodiscard]] Word revision_seen() const noexcept { return sampler_.revision_seen(); }

  /// The newest revision: one load.
  [[nodiscard]] Word revision() const noexcept { return board_.reader.revision(); }

  /// The largest rate that the law can have.
  [[nodiscard]] double max_rate() const noexcept { return ipc::max_rate(board_.header); }

  /// Whether the law has been removed.
  [[nodiscard]] bool is_lost() const noexcept { return board_.reader.retired(); }

  /// The point that at() found last, and its host time.
  [[nodiscard]] const LawPoint& last() const noexcept { return last_; }
  [[nodiscard]] Time last_host() const noexcept { return last_host_; }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  LawFollower(BoardView law, std::string name);
  [[nodiscard]] SampleStatus sample(Time host, bool is_executed, LawPoint& out) noexcept;
  [[nodiscard]] SampleStatus convert(SampleStatus status, LawPoint& out) const noexcept;

  std::string name_;
  BoardView board_;  ///< of the law
  Sampler sampler_;
  State state_;
  LawPoint last_{};
  Time last_host_{};
};

/// The law that a stream's header names; null if it names none, or if the law has been removed:
/// then nothing is held any more.
[[nodiscard]] std::unique_ptr<LawFollower> law_of(const RegionHeader& stream, const Trust& trust);

/// A clock that shows the stream time of a law. Each now() reads the host's clock before it looks
/// at the law, so that the law is settled up to the host time that it read. One thread uses it.
class LawClock final : public Clock {
 public:
  /// `host` is the host's clock; both outlive this object.
  LawClock(LawFollower& law, const Clock& host) noexcept : law_(&law), host_(&host) {}

  /// Stream time now, rounded down. While the law cannot be read, the latest that it can be.
  [[nodiscard]] Time now() const noexcept override;

  [[nodiscard]] Time host_time(Time /*now*/) const noexcept override { return host_now_; }

  /// An upper bound of the stream time when `ahead` of host time has passed since the last now():
  /// follows the law as far as it has settled, and from there its largest rate.
  [[nodiscard]] Time latest(Time now, Time ahead) const noexcept override;

  /// The stream time of the last now(), if the law has it at all times from there until it is no
  /// longer settled: then no reader has had a later one as executed or settled.
  [[nodiscard]] std::optional<Time> held() const noexcept override;

  /// Whether the law held at the last now(): stream time does not pass until the law changes.
  [[nodiscard]] bool is_held() const noexcept {
    const core::LawRates& rates = law_->last().rates;
    return rates.rate == 0 && rates.slope == 0 && rates.curvature == 0;
  }

 private:
  LawFollower* law_;
  const Clock* host_;
  mutable Time host_now_{};  ///< host time of the last now()
};

}  // namespace splinecast::ipc
