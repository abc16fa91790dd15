#pragma once

/// Promises of the solver and the readers that can be left out of this campaign: with false, it
/// neither checks one nor provokes the defect.
namespace splinecast::campaign {

/// A stop takes effect at settled_until, one step later at most, whatever is queued before it.
inline constexpr bool kStopsAtOnce = true;
/// Waypoints are withdrawn in the revision that carries their replacement out.
inline constexpr bool kWithdrawsOnlyWhatIsReplaced = true;
/// `late_commits` counts every late commit while the solver lives.
inline constexpr bool kLateCommitsAreKept = true;
/// Values of 1e-300 to 1e90, and smoothing of any λ, are published as numbers or refused.
inline constexpr bool kTakesAnyMagnitude = true;
/// A stop from velocities of a few ulp, under limits, is found in a bounded number of steps.
inline constexpr bool kStopsFromDenormals = true;

}  // namespace splinecast::campaign
