#pragma once

#include "core/polynomial/chain_rule.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

/// Turns the derivatives of a curve by stream time into those by host time, in place: see
/// ChainRule. The position stays. O(D); never throws or allocates; safe from any thread.
void follow(const LawRates& law, const StateRef& state) noexcept;

}  // namespace splinecast::core
