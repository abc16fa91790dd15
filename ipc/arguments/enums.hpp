#pragma once

#include "splinecast.h"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/status.hpp"

/// The enums of the C interface have the numbers of the library's enums.
namespace splinecast::ipc {

inline constexpr int kConditionKinds = SPLINECAST_OWN + 1;
inline constexpr int kClocks = SPLINECAST_CLOCK_LAW + 1;
inline constexpr int kWaitStatuses = SPLINECAST_WAIT_RETIRED + 1;

static_assert(SPLINECAST_APPEND_STOPPED + 1 == kAppendStatuses);
static_assert(SPLINECAST_APPEND_ELSEWHERE == static_cast<int>(AppendStatus::elsewhere));
static_assert(SPLINECAST_APPEND_FINISHED == static_cast<int>(AppendStatus::finished));
static_assert(SPLINECAST_APPEND_FULL == static_cast<int>(AppendStatus::full));
static_assert(SPLINECAST_APPEND_PAST == static_cast<int>(AppendStatus::past));
static_assert(SPLINECAST_APPEND_DUPLICATE == static_cast<int>(AppendStatus::duplicate));
static_assert(SPLINECAST_APPEND_OUT_OF_ORDER == static_cast<int>(AppendStatus::out_of_order));
static_assert(SPLINECAST_APPEND_NOT_FINITE == static_cast<int>(AppendStatus::not_finite));
static_assert(SPLINECAST_APPEND_TOO_CLOSE == static_cast<int>(AppendStatus::too_close));
static_assert(SPLINECAST_APPEND_TOO_FAR_APART == static_cast<int>(AppendStatus::too_far_apart));
static_assert(SPLINECAST_APPEND_TOO_LATE == static_cast<int>(AppendStatus::too_late));
static_assert(SPLINECAST_APPEND_TOO_MANY == static_cast<int>(AppendStatus::too_many));
static_assert(SPLINECAST_APPEND_ALREADY_STARTED == static_cast<int>(AppendStatus::already_started));

static_assert(SPLINECAST_REFUSAL_STOPPED + 1 == kRefusals);
static_assert(SPLINECAST_REFUSAL_CANNOT_FOLLOW == static_cast<int>(Refusal::cannot_follow));
static_assert(SPLINECAST_REFUSAL_BEYOND_LIMITS == static_cast<int>(Refusal::beyond_limits));
static_assert(SPLINECAST_REFUSAL_PAST == static_cast<int>(Refusal::past));
static_assert(SPLINECAST_REFUSAL_DUPLICATE == static_cast<int>(Refusal::duplicate));
static_assert(SPLINECAST_REFUSAL_OUT_OF_ORDER == static_cast<int>(Refusal::out_of_order));
static_assert(SPLINECAST_REFUSAL_NOT_FINITE == static_cast<int>(Refusal::not_finite));
static_assert(SPLINECAST_REFUSAL_TOO_CLOSE == static_cast<int>(Refusal::too_close));
static_assert(SPLINECAST_REFUSAL_TOO_FAR_APART == static_cast<int>(Refusal::too_far_apart));
static_assert(SPLINECAST_REFUSAL_TOO_LATE == static_cast<int>(Refusal::too_late));
static_assert(SPLINECAST_REFUSAL_AFTER_FINISH == static_cast<int>(Refusal::after_finish));
static_assert(SPLINECAST_REFUSAL_ALREADY_STARTED == static_cast<int>(Refusal::already_started));
static_assert(SPLINECAST_REFUSAL_UNKNOWN_KIND == static_cast<int>(Refusal::unknown_kind));
static_assert(SPLINECAST_REFUSAL_LACKS_DERIVATIVES == static_cast<int>(Refusal::lacks_derivatives));
static_assert(SPLINECAST_REFUSAL_LAG_TOO_SHORT == static_cast<int>(Refusal::lag_too_short));
static_assert(SPLINECAST_REFUSAL_ZERO_QUATERNION == static_cast<int>(Refusal::zero_quaternion));

static_assert(SPLINECAST_SAMPLE_WRONG_DIMENSION + 1 == kSampleStatuses);
static_assert(SPLINECAST_SAMPLE_PROVISIONAL == static_cast<int>(SampleStatus::provisional));
static_assert(SPLINECAST_SAMPLE_STOPPING == static_cast<int>(SampleStatus::stopping));
static_assert(SPLINECAST_SAMPLE_HOLDING == static_cast<int>(SampleStatus::holding));
static_assert(SPLINECAST_SAMPLE_REVISED == static_cast<int>(SampleStatus::revised));
static_assert(SPLINECAST_SAMPLE_BEFORE_HISTORY == static_cast<int>(SampleStatus::before_history));
static_assert(SPLINECAST_SAMPLE_NO_DATA == static_cast<int>(SampleStatus::no_data));
static_assert(SPLINECAST_SAMPLE_BUSY == static_cast<int>(SampleStatus::busy));
static_assert(SPLINECAST_SAMPLE_RETIRED == static_cast<int>(SampleStatus::retired));

static_assert(SPLINECAST_WAIT_ADVANCED == static_cast<int>(WaitStatus::advanced));
static_assert(SPLINECAST_WAIT_TIMED_OUT == static_cast<int>(WaitStatus::timed_out));
static_assert(SPLINECAST_WAIT_RETIRED == static_cast<int>(WaitStatus::retired));

static_assert(SPLINECAST_NATURAL == static_cast<int>(ConditionKind::natural));
static_assert(SPLINECAST_CLAMPED == static_cast<int>(ConditionKind::clamped));
static_assert(SPLINECAST_HALT == static_cast<int>(ConditionKind::halt));
static_assert(SPLINECAST_VELOCITY == static_cast<int>(ConditionKind::velocity));
static_assert(SPLINECAST_ACCELERATION == static_cast<int>(ConditionKind::acceleration));
static_assert(SPLINECAST_NOT_A_KNOT == static_cast<int>(ConditionKind::not_a_knot));
static_assert(SPLINECAST_PERIODIC == static_cast<int>(ConditionKind::periodic));
static_assert(SPLINECAST_OWN == static_cast<int>(ConditionKind::own));

static_assert(SPLINECAST_TAIL_BESSEL == static_cast<int>(Tail::bessel));
static_assert(SPLINECAST_TAIL_PARABOLIC == static_cast<int>(Tail::parabolic));
static_assert(SPLINECAST_TAIL_NATURAL == static_cast<int>(Tail::natural));
static_assert(SPLINECAST_TAIL_CLAMPED == static_cast<int>(Tail::clamped));

static_assert(SPLINECAST_CLOCK_RECORDED == static_cast<int>(StreamClock::recorded));
static_assert(SPLINECAST_CLOCK_LAW == static_cast<int>(StreamClock::law));
static_assert(SPLINECAST_CLOCK_MONOTONIC == static_cast<int>(StreamClock::monotonic));

static_assert(SPLINECAST_QUATERNION_WXYZ + 1 == kDimensionKinds);
static_assert(SPLINECAST_PERIODIC_VALUE == static_cast<int>(DimensionKind::periodic));
static_assert(SPLINECAST_QUATERNION == static_cast<int>(DimensionKind::quaternion));

static_assert(SPLINECAST_LIMIT_POSITION + 1 == kLimitKinds);
static_assert(SPLINECAST_LIMIT_VELOCITY == static_cast<int>(LimitKind::velocity));
static_assert(SPLINECAST_LIMIT_ACCELERATION == static_cast<int>(LimitKind::acceleration));
static_assert(SPLINECAST_LIMIT_JERK == static_cast<int>(LimitKind::jerk));

static_assert(SPLINECAST_BEYOND_REPORT == static_cast<int>(Beyond::report));
static_assert(SPLINECAST_BEYOND_REFUSE == static_cast<int>(Beyond::refuse));
static_assert(SPLINECAST_BEYOND_ENTER == static_cast<int>(Beyond::enter));
static_assert(SPLINECAST_BEYOND_ENTER + 1 == kBeyonds);

static_assert(SPLINECAST_SEGMENT_SPLINE == static_cast<int>(SegmentKind::spline));
static_assert(SPLINECAST_SEGMENT_ENTRY == static_cast<int>(SegmentKind::entry));
static_assert(SPLINECAST_SEGMENT_STOP == static_cast<int>(SegmentKind::stop));
static_assert(SPLINECAST_SEGMENT_HOLD == static_cast<int>(SegmentKind::hold));
static_assert(SPLINECAST_SEGMENT_SLOWED == static_cast<int>(SegmentKind::slowed));

static_assert(SPLINECAST_POSITION_VALUES == static_cast<int>(Derivatives::position));
static_assert(SPLINECAST_VELOCITY_VALUES == static_cast<int>(Derivatives::velocity));
static_assert(SPLINECAST_ACCELERATION_VALUES == static_cast<int>(Derivatives::acceleration));
static_assert(SPLINECAST_JERK_VALUES == static_cast<int>(Derivatives::jerk));
static_assert(SPLINECAST_ALL_VALUES == static_cast<int>(Derivatives::all));

}  // namespace splinecast::ipc
