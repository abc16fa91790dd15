// Each macro of the header initializes its struct in C11, without a warning.

#include <splinecast.h>

const splinecast_limits kLimits = SPLINECAST_LIMITS_INIT;
const splinecast_named_limits kNamedLimits = {
    "x", 0, 0, 0, -SPLINECAST_NO_BOUND, SPLINECAST_NO_BOUND};
const splinecast_refusals kRefusals = SPLINECAST_REFUSALS_INIT;
const splinecast_producer_options kProducerOptions = SPLINECAST_PRODUCER_OPTIONS_INIT;
const splinecast_preview kPreview = SPLINECAST_PREVIEW_INIT;
const splinecast_solver_options kSolverOptions = SPLINECAST_SOLVER_OPTIONS_INIT;
const splinecast_step_result kStepResult = SPLINECAST_STEP_RESULT_INIT;
const splinecast_reader_options kReaderOptions = SPLINECAST_READER_OPTIONS_INIT;
const splinecast_progress kProgress = SPLINECAST_PROGRESS_INIT;
const splinecast_segment kSegment = SPLINECAST_SEGMENT_INIT;
const splinecast_rate_commander_options kCommanderOptions = SPLINECAST_RATE_COMMANDER_OPTIONS_INIT;
const splinecast_fit_options kFitOptions = SPLINECAST_FIT_OPTIONS_INIT;
