#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/polynomial/segment.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/sampling/seconds.hpp"

namespace splinecast::ipc {

void copy_derivatives(const State& state, Derivatives asked, std::span<double> out) noexcept {
  const std::array<std::pair<Derivatives, std::span<const double>>, 4> parts{
      {{Derivatives::position, state.position()},
       {Derivatives::velocity, state.velocity()},
       {Derivatives::acceleration, state.acceleration()},
       {Derivatives::jerk, state.jerk()}}};
  for (const auto& [derivative, values] : parts) {
    if (!contains(asked, derivative)) continue;
    std::ranges::copy(values, out.begin());
    out = out.subspan(values.size());
  }
}

Word Sampler::sample_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  const std::size_t values = count(out.derivatives) * board_->dimensions();
  const bool fits = out.status.size() == times.size() && out.values.size() == times.size() * values;
  SampleStatus seen = fits ? SampleStatus::busy : SampleStatus::wrong_dimension;
  for (int attempt = 0; attempt < kTries && seen == SampleStatus::busy; ++attempt) {
    seen = see_newest(times.empty() ? Time{} : times.front());
    if (seen != SampleStatus::settled) continue;
    if (evaluate_many(times, out)) return summary_.revision;
    seen = SampleStatus::busy;
  }
  std::ranges::fill(out.status, seen);
  return 0;
}

/// Evaluates all times under summary_.revision. Returns false if the writer overtook it.
bool Sampler::evaluate_many(std::span<const Time> times, const SampleBlock& out) noexcept {
  const std::size_t dimensions = board_->dimensions();
  const std::size_t stride = count(out.derivatives) * dimensions;
  for (std::size_t i = 0; i < times.size();) {
    const Found found = continues(times[i]) ? Found::segment : locate(times[i]);
    if (found == Found::torn) return false;
    if (found == Found::segment) {
      const std::size_t evaluated = evaluate_moving(times, i, stride, out);
      i += evaluated;
      if (evaluated > 0) continue;
      out.status[i] = evaluate(kept_.current(), times[i], state_.ref());
    } else if (!is_live(clock_) || summary_.first != 1) {
      out.status[i] = SampleStatus::before_history;
    } else if (kept_.take(*board_, summary_, summary_.first)) {
      out.status[i] = hold_first(state_.ref());
    } else {
      return false;
    }
    if (has_values(out.status[i])) {
      copy_derivatives(state_, out.derivatives, out.values.subspan(i * stride, stride));
    }
    ++i;
  }
  return true;
}

/// Evaluates the times from `first` on that are in the current segment, if that is not a stop or a
/// hold. Returns their number, at most 16. Returns 0 if a dimension needs normalisation.
std::size_t Sampler::evaluate_moving(std::span<const Time> times, std::size_t first,
                                     std::size_t stride, const SampleBlock& out) noexcept {
  if (!all_linear_) return 0;
  const BoardSegment& own = kept_.current();
  const Time settled_until =
      kept_.current_interval().is_finished ? Time::max() : summary_.settled_until;
  // Not initialised, because that takes as long as the lookup.
  std::array<double, 16> u;  // NOLINT(*-member-init)
  std::size_t n = 0;
  while (n < u.size() && first + n < times.size()) {
    const Time t = times[first + n];
    if (t < kept_.current_interval().left || t >= kept_.current_interval().right) break;
    u[n] = seconds_after(kept_.current_interval().left, t);
    out.status[first + n] = t < settled_until ? SampleStatus::settled : SampleStatus::provisional;
    ++n;
  }
  core::evaluate_many(own.order(), own.coefficients(), board_->dimensions(), std::span(u).first(n),
                      out.derivatives, out.values.subspan(first * stride, n * stride), stride);
  return n;
}

}  // namespace splinecast::ipc
