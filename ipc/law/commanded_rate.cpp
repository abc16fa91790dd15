#include "ipc/law/commanded_rate.hpp"

#include <algorithm>

namespace splinecast::ipc {
namespace {

bool are_equal(const core::RateRequest& a, const core::RateRequest& b) noexcept {
  return a.rate == b.rate && a.ramp == b.ramp;
}

}  // namespace

void CommandedRate::begin(const core::RateCurve& curve, const Commanders& commanders, Time t) {
  in_force_ = {.commanders = {}, .curve = curve};
  for (const CommanderState& state : commanders.states()) {
    const core::RateRequest request = state.request(largest_);
    const bool is_above = request.rate >= curve.at(t).rate;
    in_force_.commanders.push_back(
        {.name = state.name,
         .request = request,
         .bound = is_above ? core::RateCurve(request.rate) : core::bound_after(curve, t, request)});
  }
}

/// Continues the bounds of those commanders that have made a new request.
void CommandedRate::take_requests(const Commanders& commanders, Time t) {
  for (Commander& commander : planned_.commanders) commander.is_there = false;
  Time newest = Time::min();
  for (const CommanderState& state : commanders.states()) {
    auto known = std::ranges::find(planned_.commanders, state.name, &Commander::name);
    if (known == planned_.commanders.end()) {
      planned_.commanders.push_back({.name = state.name,
                                     .request = {.rate = largest_, .ramp = kShortestRamp},
                                     .bound = core::RateCurve(largest_)});
      known = std::prev(planned_.commanders.end());
    }
    known->is_there = true;
    const core::RateRequest request = state.request(largest_);
    if (are_equal(request, known->request)) continue;
    known->request = request;
    known->bound = core::bound_after(known->bound, t, request);
    if (state.command.time < newest) continue;
    newest = state.command.time;
    planned_.ramp = request.ramp;
  }
  for (Commander& commander : planned_.commanders) {
    if (commander.is_there || commander.request.rate == largest_) continue;
    commander.request.rate = largest_;
    commander.bound = core::bound_after(commander.bound, t, commander.request);
  }
  std::erase_if(planned_.commanders, [t](const Commander& commander) {
    return !commander.is_there && commander.bound.rest(t) == Time::zero();
  });
}

std::optional<core::RateCurve> CommandedRate::plan(const Commanders& commanders, Time t) {
  planned_ = in_force_;
  take_requests(commanders, t);
  bounds_.clear();
  for (const Commander& commander : planned_.commanders) bounds_.push_back(commander.bound);
  const auto curve = core::plan_rate(in_force_.curve, t, bounds_,
                                     least_rate(commanders.states(), largest_), planned_.ramp);
  if (!curve) {
    commit();  // the bounds alone need no commit
    return std::nullopt;
  }
  planned_.curve = *curve;
  return curve;
}

}  // namespace splinecast::ipc
