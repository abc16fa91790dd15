#ifndef SPLINECAST_H
#define SPLINECAST_H

#include <stddef.h>
#include <stdint.h>

/// \file
/// The C interface of splinecast: producer, solver, reader and batch fit, for C11 and for languages
/// that call C. Producer and solver in one thread:
///
///     splinecast_producer* producer = NULL;
///     splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
///     options.dimensions = 2;
///     if (splinecast_producer_create("arm", &options, &producer) < 0) {
///       fprintf(stderr, "%s\n", splinecast_last_error());
///     }
///     splinecast_solver* solver = NULL;
///     splinecast_solver_create("arm", NULL, &solver);
///     while (splinecast_solver_attach(solver) == 0) splinecast_solver_wait(solver, 50000000);
///     splinecast_waypoint waypoint = {begin, {x, 2, 1}, {NULL, 0, 0}, {NULL, 0, 0}};
///     if (splinecast_producer_append(producer, &waypoint) == SPLINECAST_APPEND_ACCEPTED) {
///       while (splinecast_solver_step(solver, NULL) > 0) {}
///       splinecast_solver_wait(solver, interval);  // returns when the solver is due
///     }
///
/// Results. A function that returns `int` returns a `splinecast_error`, which is negative, or its
/// result: 0 or more. Unless its text says otherwise, the result is 0. After an error
/// splinecast_last_error() names the argument and its value, and what the function would have
/// written is unchanged. No C++ exception leaves a function.
///
/// Arguments. Every pointer must be aligned to its type, and must not be NULL unless the text says
/// so. An array must have exactly the number of values that the function needs. Every violation
/// is SPLINECAST_ERROR_ARGUMENT. Texts end with a zero byte and have at most 4,095 bytes before it.
///
/// Times are int64_t nanoseconds: of CLOCK_MONOTONIC on a live stream. On a stream that follows a
/// time law they are its stream time, except those of splinecast_reader_sample, preview and
/// sample_many. A time-out of 0 or less does not wait.
///
/// Structs whose first member is `size` may grow in later versions. Initialize one with its macro
/// SPLINECAST_…_INIT, which sets `size` and the defaults. The library sets what an older, smaller
/// struct lacks to its default. It refuses a larger one if the bytes that it does not know are not
/// all 0. All other structs never change.
///
/// Handles. One thread at a time uses a handle, and what it returns pointers to; any thread may use
/// other handles. A handle of another type, and most destroyed ones, are
/// SPLINECAST_ERROR_ARGUMENT. Create handles after fork().
///
/// Allocation. A function neither allocates nor blocks unless its text says so; an error may
/// allocate.

#define SPLINECAST_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/// Why a function failed.
typedef enum splinecast_error {
  SPLINECAST_ERROR_ARGUMENT = -1,   ///< an argument cannot be used: see splinecast_last_error()
  SPLINECAST_ERROR_NO_STREAM = -2,  ///< there is no stream of this name, or none in time
  SPLINECAST_ERROR_BUSY = -3,       ///< another living process owns what was to be written
  SPLINECAST_ERROR_REGION = -4,     ///< a shared region or its lock must not be used
  SPLINECAST_ERROR_RESOURCES = -5,  ///< no memory, shared memory or file descriptor is left: retry
  SPLINECAST_ERROR_INTERNAL = -6    ///< a defect of the library
} splinecast_error;

/// A short text for a result: of a splinecast_error; "no error" for 0 or more; never NULL.
SPLINECAST_API const char* splinecast_strerror(int result);

/// The message of the last failure in this thread, with the offending values; "" if there was none.
/// The thread's next failure replaces it. At most 511 bytes; a longer message is cut.
SPLINECAST_API const char* splinecast_last_error(void);

/// The version of the library: "0.1.0".
SPLINECAST_API const char* splinecast_version(void);

/// The time of CLOCK_MONOTONIC, which live streams use.
SPLINECAST_API int64_t splinecast_now(void);

/// Removes a stream: takes both locks, wakes readers, unlinks regions and lock files. Fails with
/// BUSY if a writer of the stream lives. System calls; allocates.
SPLINECAST_API int splinecast_remove(const char* stream);

// ---------------------------------------------------------------------------------------- arrays

/// `count` values, `stride` values from one to the next: 0 means 1; a negative stride is allowed,
/// `data` is always the first value. `data` NULL with `count` 0: not given.
typedef struct splinecast_vector {
  const double* data;
  size_t count;
  ptrdiff_t stride;
} splinecast_vector;

/// A vector to be written. `data` NULL with `count` 0: not wanted.
typedef struct splinecast_output {
  double* data;
  size_t count;
  ptrdiff_t stride;
} splinecast_output;

/// Times, with a stride as in splinecast_vector.
typedef struct splinecast_times {
  const int64_t* data;
  size_t count;
  ptrdiff_t stride;
} splinecast_times;

/// `rows` × `columns` values. Strides in values: a `column_stride` of 0 means 1, a `row_stride` of
/// 0 means that the rows follow each other: columns · column_stride. `data` NULL with `rows` 0: not
/// given.
typedef struct splinecast_matrix {
  const double* data;
  size_t rows;
  size_t columns;
  ptrdiff_t row_stride;
  ptrdiff_t column_stride;
} splinecast_matrix;

/// A matrix to be written; strides as in splinecast_matrix.
typedef struct splinecast_output_matrix {
  double* data;
  size_t rows;
  size_t columns;
  ptrdiff_t row_stride;
  ptrdiff_t column_stride;
} splinecast_output_matrix;

/// A waypoint: a time, a position and, optionally, velocity and acceleration, one value per
/// dimension.
typedef struct splinecast_waypoint {
  int64_t time;
  splinecast_vector position;
  splinecast_vector velocity;
  splinecast_vector acceleration;
} splinecast_waypoint;

/// Waypoints in columns: times, and one row of positions for each; optionally velocities and
/// accelerations of the same shape.
typedef struct splinecast_waypoints {
  splinecast_times times;
  splinecast_matrix positions;
  splinecast_matrix velocities;
  splinecast_matrix accelerations;
} splinecast_waypoints;

/// Where a sample is written: position [unit], velocity [unit/s], acceleration [unit/s²] and jerk
/// [unit/s³], one value per dimension. A derivative that is not wanted has `data` NULL.
typedef struct splinecast_state {
  splinecast_output position;
  splinecast_output velocity;
  splinecast_output acceleration;
  splinecast_output jerk;
} splinecast_state;

// -------------------------------------------------------------------------- statuses and choices

/// The result of an append. Only `accepted` changes anything.
typedef enum splinecast_append_status {
  SPLINECAST_APPEND_ACCEPTED,
  SPLINECAST_APPEND_FULL,           ///< no room until the solver consumes: retry
  SPLINECAST_APPEND_PAST,           ///< live: the time has passed, or is settled
  SPLINECAST_APPEND_DUPLICATE,      ///< the time of the previous waypoint
  SPLINECAST_APPEND_OUT_OF_ORDER,   ///< earlier than the previous waypoint
  SPLINECAST_APPEND_NOT_FINITE,     ///< a value is NaN, infinite or beyond ±1e100
  SPLINECAST_APPEND_TOO_CLOSE,      ///< less than min_interval after the previous waypoint
  SPLINECAST_APPEND_TOO_FAR_APART,  ///< more than max_interval after it; or a blend longer than it
  SPLINECAST_APPEND_WRONG_DIMENSION,  ///< not returned: SPLINECAST_ERROR_ARGUMENT instead
  SPLINECAST_APPEND_TOO_LATE,         ///< a replacement at a settled time
  SPLINECAST_APPEND_TOO_MANY,         ///< a replacement that does not fit even into an empty ring
  SPLINECAST_APPEND_ALREADY_STARTED,  ///< a start state after the first waypoint
  SPLINECAST_APPEND_FINISHED,         ///< the stream has been finished
  SPLINECAST_APPEND_CANNOT_FOLLOW,    ///< no waypoint met for 3 s, and the curve moves until then
  SPLINECAST_APPEND_TOO_FAR_AHEAD,    ///< live, without a law: more than the horizon after now
  SPLINECAST_APPEND_ELSEWHERE,        ///< live: not where an earlier stream has left the machine
  SPLINECAST_APPEND_STOPPED           ///< live: a stopper holds the stream
} splinecast_append_status;

/// Why the solver refused an item that the ring had accepted.
typedef enum splinecast_refusal_reason {
  SPLINECAST_REFUSAL_PAST = 1,
  SPLINECAST_REFUSAL_DUPLICATE = 2,
  SPLINECAST_REFUSAL_OUT_OF_ORDER = 3,
  SPLINECAST_REFUSAL_NOT_FINITE = 4,
  SPLINECAST_REFUSAL_TOO_CLOSE = 5,
  SPLINECAST_REFUSAL_TOO_FAR_APART = 6,
  SPLINECAST_REFUSAL_TOO_LATE = 7,
  SPLINECAST_REFUSAL_AFTER_FINISH = 8,
  SPLINECAST_REFUSAL_ALREADY_STARTED = 9,
  SPLINECAST_REFUSAL_UNKNOWN_KIND = 10,
  SPLINECAST_REFUSAL_LACKS_DERIVATIVES = 11,  ///< the method needs a velocity or an acceleration
  SPLINECAST_REFUSAL_LAG_TOO_SHORT = 12,      ///< for λ with waypoints this close
  SPLINECAST_REFUSAL_ZERO_QUATERNION = 13,
  SPLINECAST_REFUSAL_BEYOND_LIMITS = 14,  ///< the curve would exceed a limit
  SPLINECAST_REFUSAL_CANNOT_FOLLOW = 15,  ///< none met for 3 s, and no entry leads to it
  SPLINECAST_REFUSAL_STOPPED = 16         ///< a stopper held the stream
} splinecast_refusal_reason;

/// What became of an item that the ring has accepted.
typedef enum splinecast_outcome_kind {
  SPLINECAST_OUTCOME_WAITING,      ///< no solver has taken it yet
  SPLINECAST_OUTCOME_UNDECIDED,    ///< taken, but a transition may still pass over it
  SPLINECAST_OUTCOME_IN_FORCE,     ///< at `time`
  SPLINECAST_OUTCOME_PASSED_OVER,  ///< the curve goes from before the waypoint to a later one
  SPLINECAST_OUTCOME_WITHDRAWN,    ///< a replacement or a stop took its place
  SPLINECAST_OUTCOME_REFUSED,      ///< by the solver, for `reason`
  SPLINECAST_OUTCOME_FORGOTTEN     ///< not known any more
} splinecast_outcome_kind;

/// By which part of the curve an item is in force.
typedef enum splinecast_outcome_way {
  SPLINECAST_WAY_SPLINE,  ///< the spline through the waypoints
  SPLINECAST_WAY_ENTRY,   ///< a transition ends at the waypoint, or begins with the item
  SPLINECAST_WAY_STOP,    ///< a stop, which begins at `time`
  SPLINECAST_WAY_END      ///< the curve slows down or ends there, or rests from then on
} splinecast_outcome_way;

/// The validity of a sample. Up to `revised` it has values; the others leave the state unchanged.
typedef enum splinecast_sample_status {
  SPLINECAST_SAMPLE_SETTLED,         ///< final: the same bits for every reader, now and later
  SPLINECAST_SAMPLE_PROVISIONAL,     ///< a newer waypoint or a replacement may still change it
  SPLINECAST_SAMPLE_STOPPING,        ///< in the stop segment after the newest waypoint
  SPLINECAST_SAMPLE_HOLDING,         ///< at rest
  SPLINECAST_SAMPLE_REVISED,         ///< valid, but the curve changed before a time sampled; once
  SPLINECAST_SAMPLE_BEFORE_HISTORY,  ///< before what the board keeps
  SPLINECAST_SAMPLE_NO_DATA,         ///< no waypoint has been solved yet
  SPLINECAST_SAMPLE_BUSY,            ///< the writer overtook every try: retry
  SPLINECAST_SAMPLE_RETIRED,         ///< the stream was removed or recreated: make a new reader
  SPLINECAST_SAMPLE_WRONG_DIMENSION  ///< not returned: SPLINECAST_ERROR_ARGUMENT instead
} splinecast_sample_status;

/// Why splinecast_reader_wait returned.
typedef enum splinecast_wait_status {
  SPLINECAST_WAIT_ADVANCED,  ///< there is a revision that this reader has not seen
  SPLINECAST_WAIT_TIMED_OUT,
  SPLINECAST_WAIT_RETIRED  ///< make a new reader
} splinecast_wait_status;

/// Texts of statuses and reasons, as in files and messages: "out of order". "unknown" for other
/// numbers; never NULL.
SPLINECAST_API const char* splinecast_append_text(int append_status);
SPLINECAST_API const char* splinecast_refusal_text(int refusal_reason);
SPLINECAST_API const char* splinecast_sample_text(int sample_status);
SPLINECAST_API const char* splinecast_outcome_text(int outcome_kind);
SPLINECAST_API const char* splinecast_way_text(int outcome_way);
SPLINECAST_API const char* splinecast_wait_text(int wait_status);

/// Whether a sample of this status has values: 0 or 1; 0 for other numbers.
SPLINECAST_API int splinecast_has_values(int sample_status);

/// A boundary condition.
typedef enum splinecast_condition_kind {
  SPLINECAST_NATURAL,       ///< acceleration 0
  SPLINECAST_CLAMPED,       ///< velocity 0
  SPLINECAST_HALT,          ///< velocity and acceleration 0
  SPLINECAST_VELOCITY,      ///< given velocity
  SPLINECAST_ACCELERATION,  ///< given acceleration
  SPLINECAST_NOT_A_KNOT,    ///< batch c2 only
  SPLINECAST_PERIODIC,      ///< batch c2 only, at both ends
  SPLINECAST_OWN            ///< the default of the method
} splinecast_condition_kind;

/// A condition and, for `velocity` and `acceleration`, one value per dimension.
typedef struct splinecast_condition {
  int kind;  ///< splinecast_condition_kind
  splinecast_vector value;
} splinecast_condition;

/// The boundary condition at the newest knot while a stream continues.
typedef enum splinecast_tail {
  SPLINECAST_TAIL_BESSEL,     ///< slope of the parabola through the last three waypoints
  SPLINECAST_TAIL_PARABOLIC,  ///< the last segment has no cubic term
  SPLINECAST_TAIL_NATURAL,    ///< acceleration 0
  SPLINECAST_TAIL_CLAMPED     ///< velocity 0
} splinecast_tail;

/// The clock of a stream's times.
typedef enum splinecast_clock {
  SPLINECAST_CLOCK_RECORDED,   ///< time stamps of a recording
  SPLINECAST_CLOCK_MONOTONIC,  ///< a live stream: CLOCK_MONOTONIC of this host
  SPLINECAST_CLOCK_LAW  ///< a live stream: the stream time of its law; readers give host time
} splinecast_clock;

/// What the values of a dimension are.
typedef enum splinecast_dimension_kind {
  SPLINECAST_LINEAR,
  SPLINECAST_PERIODIC_VALUE,  ///< values repeat with a period: the curve takes the shorter way
  SPLINECAST_QUATERNION,      ///< one of four consecutive dimensions: a rotation as x y z w
  SPLINECAST_QUATERNION_WXYZ  ///< the same, as w x y z
} splinecast_dimension_kind;

/// The kind of one dimension.
typedef struct splinecast_dimension {
  int kind;       ///< splinecast_dimension_kind
  double period;  ///< of a periodic dimension, in its unit; else 0
} splinecast_dimension;

/// A kind of limit.
typedef enum splinecast_limit_kind {
  SPLINECAST_LIMIT_VELOCITY,
  SPLINECAST_LIMIT_ACCELERATION,
  SPLINECAST_LIMIT_JERK,
  SPLINECAST_LIMIT_POSITION
} splinecast_limit_kind;

/// What a solver does with a waypoint that makes the curve exceed a limit.
typedef enum splinecast_beyond {
  SPLINECAST_BEYOND_REPORT,  ///< accept it, count it and record where
  SPLINECAST_BEYOND_REFUSE,
  SPLINECAST_BEYOND_ENTER  ///< accept it, and leave the spline within the limits; live streams only
} splinecast_beyond;

/// The purpose of a segment.
typedef enum splinecast_segment_kind {
  SPLINECAST_SEGMENT_SPLINE,  ///< between two waypoints
  SPLINECAST_SEGMENT_ENTRY,   ///< from a given state onto the waypoints
  SPLINECAST_SEGMENT_STOP,    ///< after the newest knot, ends at rest
  SPLINECAST_SEGMENT_HOLD,    ///< at rest
  SPLINECAST_SEGMENT_SLOWED   ///< between two waypoints of a path on which the curve comes to rest
} splinecast_segment_kind;

/// Derivatives, for splinecast_reader_sample_many: a set is a sum of these.
enum {
  SPLINECAST_POSITION_VALUES = 1,
  SPLINECAST_VELOCITY_VALUES = 2,
  SPLINECAST_ACCELERATION_VALUES = 4,
  SPLINECAST_JERK_VALUES = 8,
  SPLINECAST_ALL_VALUES = 15
};

// ---------------------------------------------------------------------------------------- limits

/// Motion limits in the units of the dimensions. One value per dimension, or one for all; not
/// given: no limit of that kind.
typedef struct splinecast_limits {
  size_t size;
  splinecast_vector velocity;  ///< limits of absolute values, as the next two; 0: none
  splinecast_vector acceleration;
  splinecast_vector jerk;
  splinecast_vector lower;  ///< bounds of the position; ±SPLINECAST_NO_BOUND: none
  splinecast_vector upper;
} splinecast_limits;
#define SPLINECAST_NO_VECTOR \
  { NULL, 0, 0 }
#define SPLINECAST_NO_BOUND (__builtin_inf())
#define SPLINECAST_LIMITS_INIT                                                                   \
  {                                                                                              \
    sizeof(splinecast_limits), SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR, \
        SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR                                               \
  }

/// The limits of the dimension with this name. 0: none; bounds as in splinecast_limits.
typedef struct splinecast_named_limits {
  const char* name;
  double velocity;
  double acceleration;
  double jerk;
  double lower;
  double upper;
} splinecast_named_limits;

/// The place nearest to a limit, or the farthest beyond one.
typedef struct splinecast_excess {
  double ratio;      ///< value / limit: above 1 it exceeds the limit; below 0: there are no limits
  double value;      ///< signed; for a quaternion, an upper bound of the magnitude
  double limit;      ///< the limit, or the bound of a position
  size_t dimension;  ///< for a quaternion its first
  int kind;          ///< splinecast_limit_kind
  int reserved;      ///< 0
} splinecast_excess;

/// A waypoint with which the curve exceeds a limit, and where.
typedef struct splinecast_limit_excess {
  uint64_t item;  ///< number of the waypoint's item
  int64_t time;
  double value;      ///< signed; for a quaternion, an upper bound of the magnitude
  double limit;      ///< the limit, or the bound of a position
  size_t dimension;  ///< for a quaternion its first
  int kind;          ///< splinecast_limit_kind
  int is_refused;    ///< 1: the waypoint was refused; 0: accepted
} splinecast_limit_excess;

/// An item that the ring accepted and the solver refused.
typedef struct splinecast_refusal {
  uint64_t item;                   ///< its number: splinecast_producer_last_item after its append
  int64_t time;                    ///< if `has_time`: else the ring has overwritten it
  int reason;                      ///< splinecast_refusal_reason
  int has_time;                    ///< 0 or 1
  int has_excess;                  ///< 0 or 1: `beyond_limits`, while the board has the excess
  int reserved;                    ///< 0
  splinecast_limit_excess excess;  ///< if `has_excess`
  char by[40];                     ///< of `stopped`: a stopper's name, or its first 32 bytes; "":
                                   ///< the board no longer has it
} splinecast_refusal;

/// The outcome of an item.
typedef struct splinecast_outcome {
  size_t size;
  int kind;      ///< splinecast_outcome_kind
  int way;       ///< splinecast_outcome_way, if in force; else 0
  int reason;    ///< splinecast_refusal_reason, if refused; else 0
  int is_final;  ///< 1: nothing can change it any more
  int64_t time;  ///< if in force: of a late replacement, and of the waypoints of an end that slows
                 ///< down, later than the item's own time; else 0
} splinecast_outcome;
#define SPLINECAST_OUTCOME_INIT \
  { sizeof(splinecast_outcome), 0, 0, 0, 0, 0 }

/// Room for refusals, and what a call has written to it.
typedef struct splinecast_refusals {
  size_t size;
  splinecast_refusal* items;  ///< room for `capacity`; may be NULL if that is 0
  size_t capacity;
  size_t item_size;   ///< sizeof(splinecast_refusal); bytes that the library does not know become 0
  size_t count;       ///< written: items
  uint64_t missed;    ///< written: refusals since the last call that the board no longer has
  uint64_t consumed;  ///< written: refusals of all items below this number have been reported
} splinecast_refusals;
#define SPLINECAST_REFUSALS_INIT \
  { sizeof(splinecast_refusals), NULL, 0, sizeof(splinecast_refusal), 0, 0, 0 }

/// Write a message to `text`, with a zero byte at its end, cut to `capacity` bytes; return its full
/// length in bytes. `text` may be NULL if `capacity` is 0. `name`, which may be NULL, is that of
/// the excess's dimension. Allocate. "item 17 refused: too late (time 123 ns)"; "acceleration of
/// dimension 2 (wrist) is 12.5 at 456 ns, limit 10".
SPLINECAST_API int splinecast_refusal_message(const splinecast_refusal* refusal, char* text,
                                              size_t capacity);
SPLINECAST_API int splinecast_excess_message(const splinecast_limit_excess* excess,
                                             const char* name, char* text, size_t capacity);
/// The same, for a time that a live stream refuses: compares it with now on CLOCK_MONOTONIC, and
/// names the clock that it looks like.
SPLINECAST_API int splinecast_time_message(int64_t time, char* text, size_t capacity);

// -------------------------------------------------------------------------------------- producer

/// The role that appends waypoints: the one writer of a stream's waypoint ring.
typedef struct splinecast_producer splinecast_producer;

/// The properties of a stream.
typedef struct splinecast_producer_options {
  size_t size;
  size_t dimensions;         ///< 1 to 64
  const char* const* names;  ///< one per dimension, or NULL; each is cut to 31 bytes
  size_t name_count;
  const char* const* units;  ///< one per dimension, or NULL; each is cut to 15 bytes
  size_t unit_count;
  const splinecast_dimension* kinds;  ///< one per dimension, or NULL: all linear
  size_t kind_count;
  splinecast_condition
      start;               ///< one that can be met online: up to SPLINECAST_ACCELERATION, or OWN
  int64_t min_interval;    ///< between two waypoints: 1 ns or more; default 1 µs
  int64_t max_interval;    ///< min_interval or more, below 2⁶¹ ns; default 1 h
  size_t capacity;         ///< ring items, 2 to 2²⁴; default 1,024; rounded up to a power of two
  int clock;               ///< splinecast_clock
  uint32_t mode;           ///< permission bits of the regions, up to 0777
  int64_t group;           ///< group of the regions; −1: this process's
  int64_t owner;           ///< also trust regions of this user; −1: own user and root only
  const char* law;         ///< time law that the stream follows, with SPLINECAST_CLOCK_LAW; or NULL
  int64_t horizon;         ///< live, without a law: how far ahead of now a time may be; above 0;
                           ///< default 1 h; INT64_MAX: no time is compared with now
  double start_tolerance;  ///< live: distance of the first waypoint from the old end, in dimensions
                           ///< without limits, in the dimension's unit or rad: 0 or more;
                           ///< default 0.001
} splinecast_producer_options;
/// One dimension, a live stream from a full stop, intervals of 1 µs to 1 h, 1,024 items, a horizon
/// of 1 h, a start tolerance of 0.001.
#define SPLINECAST_PRODUCER_OPTIONS_INIT                                              \
  {                                                                                   \
    sizeof(splinecast_producer_options), 1, NULL, 0, NULL, 0, NULL, 0,                \
        {SPLINECAST_HALT, SPLINECAST_NO_VECTOR}, 1000, INT64_C(3600000000000), 1024,  \
        SPLINECAST_CLOCK_MONOTONIC, 0600, -1, -1, NULL, INT64_C(3600000000000), 0.001 \
  }

/// What a replacement would do. The caller sets the six outputs: largest magnitudes of velocity
/// [unit/s], acceleration and jerk, one value per dimension, of the entry and of the whole motion.
typedef struct splinecast_preview {
  size_t size;
  int status;               ///< splinecast_append_status; unless accepted, the rest is unchanged
  int is_known;             ///< 1: the curve's state at t was read; 0: what follows is unchanged
  int64_t begin;            ///< of the motion: t; for a stop at a settled time, settled_until
  int64_t duration;         ///< of the entry onto the waypoints, or of the stop
  int64_t waypoint;         ///< where the entry ends; −1: beyond the last waypoint
  size_t passed_over;       ///< waypoints before the end of the entry
  int enters;               ///< 1: there is an entry; 0: the curve comes to rest
  int from_rest;            ///< 1: it begins at rest where the stream's time law holds it
  splinecast_excess worst;  ///< nearest to a limit, or farthest beyond one
  splinecast_output entry_velocity;  ///< of the entry; of the stop if there is no entry
  splinecast_output entry_acceleration;
  splinecast_output entry_jerk;
  splinecast_output motion_velocity;  ///< from t until the curve rests
  splinecast_output motion_acceleration;
  splinecast_output motion_jerk;
} splinecast_preview;
#define SPLINECAST_PREVIEW_INIT                                                                 \
  {                                                                                             \
    sizeof(splinecast_preview), 0, 0, 0, 0, -1, 0, 0, 0, {-1, 0, 0, 0, 0, 0},                   \
        SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR, \
        SPLINECAST_NO_VECTOR, SPLINECAST_NO_VECTOR                                              \
  }

/// Creates a stream, creates it again if it is finished, or continues it if its producer died.
/// `options` NULL: the defaults. Writes the handle to `out`; NULL after an error. System calls;
/// allocates.
SPLINECAST_API int splinecast_producer_create(const char* stream,
                                              const splinecast_producer_options* options,
                                              splinecast_producer** out);

/// Destroys a handle; the stream remains. NULL has no effect. System calls.
SPLINECAST_API int splinecast_producer_destroy(splinecast_producer* producer);

/// Appends a waypoint. Returns a splinecast_append_status. The first one after a producer that died
/// replaces its motion as soon as possible, if it does not continue it, which adds an item before
/// it: see docs/live-streams.md. One system call if it wakes a sleeping solver; until a solver has
/// attached, each call looks for one, which may allocate. O(D).
SPLINECAST_API int splinecast_producer_append(splinecast_producer* producer,
                                              const splinecast_waypoint* waypoint);

/// Appends waypoints in order, up to the first that is not accepted. Returns that one's status, or
/// accepted. Writes the number of those accepted to `appended`, which may be NULL. As append.
SPLINECAST_API int splinecast_producer_append_many(splinecast_producer* producer,
                                                   const splinecast_waypoints* waypoints,
                                                   size_t* appended);

/// Replaces everything after time `t` by these waypoints as one revision; INT64_MIN: as soon as
/// possible. The curve continues from its state at t by an entry of at least `blend` ns;
/// `waypoints` NULL or without rows: it stops. If the solver takes it later than that, it takes
/// effect as soon as possible, and passes over the waypoints before.
/// Returns a splinecast_append_status. Allocates if it has more waypoints than any replacement
/// before it; else as append.
SPLINECAST_API int splinecast_producer_replace_from(splinecast_producer* producer, int64_t t,
                                                    const splinecast_waypoints* waypoints,
                                                    int64_t blend);

/// Computes what replace_from would do with these arguments, without changing anything. Allocates.
SPLINECAST_API int splinecast_producer_preview_replace(splinecast_producer* producer, int64_t t,
                                                       const splinecast_waypoints* waypoints,
                                                       int64_t blend, splinecast_preview* out);

/// Sets the state in which the stream starts, before the first waypoint: where the machine is.
/// Velocity and acceleration must be given. Returns a splinecast_append_status: `elsewhere` if an
/// earlier live stream has left the machine farther away than start_tolerance. As append.
SPLINECAST_API int splinecast_producer_start_from(splinecast_producer* producer,
                                                  const splinecast_waypoint* state);

/// The same for a machine that was moved since the earlier stream: it is not compared with that
/// end. Without velocity and acceleration nothing is written: the machine rests at the position,
/// and the first waypoint is compared with it.
SPLINECAST_API int splinecast_producer_start_moved(splinecast_producer* producer,
                                                   const splinecast_waypoint* state);

/// Where an earlier live stream of this name has left the machine, and the earliest time at which
/// this stream can start there. Returns 1, or 0 if there is no such place: then nothing is written.
/// System calls; may allocate.
SPLINECAST_API int splinecast_producer_old_end(splinecast_producer* producer, int64_t* time,
                                               const splinecast_output* position);

/// Writes why a first waypoint is `elsewhere`, as splinecast_refusal_message does; "" if there is
/// no old end.
SPLINECAST_API int splinecast_producer_elsewhere_message(splinecast_producer* producer,
                                                         const splinecast_waypoint* first,
                                                         char* text, size_t capacity);

/// Writes the names of the stoppers that hold the stream, separated by ", ", as
/// splinecast_refusal_message does; "" if there is none. Reads the board.
SPLINECAST_API int splinecast_producer_stopped_by(splinecast_producer* producer, char* text,
                                                  size_t capacity);

/// Ends the stream at its last waypoint, with this condition; NULL: a full stop. A live stream
/// needs `clamped` or `halt`. Returns a splinecast_append_status. Allocates if the condition has
/// values; else as append.
SPLINECAST_API int splinecast_producer_finish(splinecast_producer* producer,
                                              const splinecast_condition* end);

/// Writes the items that the solver has refused since the last call, oldest first, and returns
/// their number. Those for which there is no room are left for the next call; `consumed` counts
/// only what has been written. Does not allocate after a call in which nothing was refused.
SPLINECAST_API int splinecast_producer_refusals(splinecast_producer* producer,
                                                splinecast_refusals* out);

/// Writes the number of the item of the last call that was accepted: of a waypoint, a start state
/// or the finish; of a replacement or a stop that of the replacement, whose waypoint i has this
/// number + 1 + i.
SPLINECAST_API int splinecast_producer_last_item(splinecast_producer* producer, uint64_t* item);

/// Writes what became of an item, by the newest revision, and returns its kind. The board keeps the
/// last 256 outcomes that are not those of a waypoint on the spline at its own time, and the last
/// 1,024 refusals. `forgotten`: there may have been an older one, or the ring no longer has the
/// item, or another solver took it, and there is no record. Allocates nothing.
SPLINECAST_API int splinecast_producer_outcome(splinecast_producer* producer, uint64_t item,
                                               splinecast_outcome* out);

/// The same, once the outcome is known, neither `waiting` nor `undecided`, or after the time-out.
/// Blocks.
SPLINECAST_API int splinecast_producer_wait_outcome(splinecast_producer* producer, uint64_t item,
                                                    int64_t timeout, splinecast_outcome* out);

/// Wait until a solver has attached, until the ring has room for a waypoint, or until the solver
/// has consumed everything. Return 1, or 0 after the time-out. Block.
SPLINECAST_API int splinecast_producer_wait_for_solver(splinecast_producer* producer,
                                                       int64_t timeout);
SPLINECAST_API int splinecast_producer_wait_for_room(splinecast_producer* producer,
                                                     int64_t timeout);
SPLINECAST_API int splinecast_producer_wait_until_consumed(splinecast_producer* producer,
                                                           int64_t timeout);

/// Whether a solver process lives: 1 or 0; 1 if no file descriptor is left to find out. System
/// calls.
SPLINECAST_API int splinecast_producer_solver_alive(splinecast_producer* producer);

/// The earliest time at which a replacement that is sent now takes effect at its own time: of a
/// live stream the later of the settled time and now + freeze_ahead, plus the longest pause of the
/// solver in the last second, at least 0.2 ms; of a recorded one the settled time, or INT64_MIN.
SPLINECAST_API int splinecast_producer_earliest(splinecast_producer* producer, int64_t* time);

/// Where the motion of this producer's last replacement begins, and whether it begins at rest,
/// where the stream's time law held it (1 or 0). Returns 1; 0 while the solver has not taken it, if
/// it was refused, and if the board no longer keeps it.
SPLINECAST_API int splinecast_producer_replacement_begin(splinecast_producer* producer,
                                                         int64_t* begin, int* from_rest);

/// The time of the stream's clock: CLOCK_MONOTONIC; the stream time of the law that the stream
/// follows; 0 of a recorded stream.
SPLINECAST_API int splinecast_producer_now(splinecast_producer* producer, int64_t* time);

/// Time of the newest item, of this or an earlier producer; 0 if there is none.
SPLINECAST_API int splinecast_producer_last_time(splinecast_producer* producer, int64_t* time);

/// Items appended, and items of these that the solver has consumed.
SPLINECAST_API int splinecast_producer_appended(splinecast_producer* producer, uint64_t* items);
SPLINECAST_API int splinecast_producer_consumed(splinecast_producer* producer, uint64_t* items);

/// The stream's random number.
SPLINECAST_API int splinecast_producer_stream_id(splinecast_producer* producer, uint64_t* id);

/// Whether this producer continues the ring of one that ended before finishing: 1 or 0.
SPLINECAST_API int splinecast_producer_continues(splinecast_producer* producer);

/// Whether the region's pages are locked into memory: 1 or 0.
SPLINECAST_API int splinecast_producer_is_memory_locked(splinecast_producer* producer);

/// Removes the stream's waypoint region: for a stream to which no solver ever attached. The handle
/// can then only be destroyed. System calls.
SPLINECAST_API int splinecast_producer_withdraw(splinecast_producer* producer);

// ---------------------------------------------------------------------------------------- solver

/// The role that turns waypoints into segments: the one writer of a stream's knot board. It starts
/// no thread. After each item, and no later than due(), the program calls step.
typedef struct splinecast_solver splinecast_solver;

/// The properties of a curve. A number of −1 or a pointer NULL is not set: then a new board takes
/// the default, and a board that is taken over keeps what it has.
typedef struct splinecast_solver_options {
  size_t size;
  const char* method;  ///< its name; default "c2"
  double lambda;       ///< of smoothing, which needs it: 0 to 1e100 s³
  double time_scale;   ///< of rounded: above 0, at most 1e100 s; default 1 s
  int64_t settle;      ///< settle lag K, 0 to 64; default 8 for c2, 64 for smoothing, else the
                       ///< look-ahead of the method
  int64_t stop_time;   ///< length of the stop segment: above 0, at most 2⁶⁰ ns; default 250 ms
  int64_t freeze_ahead;  ///< live: settles this long ahead of now: 1 ns to 1 min; default 5 ms
  int64_t history;       ///< live: kept after its end: 0 to 24 h; default 1 s
  int64_t min_entry;     ///< live: least length of an entry: 1 ns to 1 min; default freeze_ahead
  int64_t capacity;      ///< segments of history: 2(K + 6) + 2 to 2²²; default 4,096
  const splinecast_limits* limits;
  const splinecast_named_limits* named_limits;  ///< for the kinds that `limits` does not give
  size_t named_limit_count;
  int tail;       ///< splinecast_tail; default bessel
  int beyond;     ///< splinecast_beyond; default report
  int force_lag;  ///< 1: of smoothing: accept a lag that is too short for λ; default 0
  int wake;       ///< 1: wake waiting readers, one system call per revision; 0: do not; default 1
  int64_t group;  ///< group of the regions; −1: this process's
  int64_t owner;  ///< also trust regions of this user; −1: own user and root only
  uint32_t mode;  ///< permission bits of the regions, up to 0777; default 0600
  uint32_t reserved;    ///< 0
  double largest_rate;  ///< of a time law: above 0, at most 100; default 1
} splinecast_solver_options;
#define SPLINECAST_SOLVER_OPTIONS_INIT                                                          \
  {                                                                                             \
    sizeof(splinecast_solver_options), NULL, -1, -1, -1, -1, -1, -1, -1, -1, NULL, NULL, 0, -1, \
        -1, 0, 1, -1, -1, 0600, 0, -1                                                           \
  }

/// What one step did.
typedef struct splinecast_step_result {
  size_t size;
  uint64_t consumed;  ///< ring items consumed
  int published;      ///< 1: a revision was committed
  int missed;         ///< 1: a revision was discarded because it was too late
  int damaged;        ///< 1: another process has written to the board; the step did nothing
  int reserved;       ///< 0
} splinecast_step_result;
#define SPLINECAST_STEP_RESULT_INIT \
  { sizeof(splinecast_step_result), 0, 0, 0, 0, 0 }

/// Becomes the stream's solver; the stream need not exist yet. `options` NULL: the defaults. Writes
/// the handle to `out`; NULL after an error. System calls; allocates.
SPLINECAST_API int splinecast_solver_create(const char* stream,
                                            const splinecast_solver_options* options,
                                            splinecast_solver** out);

/// Destroys a handle; the stream remains. NULL has no effect. System calls.
SPLINECAST_API int splinecast_solver_destroy(splinecast_solver* solver);

/// Attaches to the stream once its producer has created it. Returns 1 if it is attached; 0 if the
/// stream does not exist, or while the curve of an earlier one still moves: retry. System calls;
/// allocates.
SPLINECAST_API int splinecast_solver_attach(splinecast_solver* solver);

/// Consumes waypoints and publishes. Returns 1 if it must be called again at once, because it has
/// consumed items or discarded a revision; else 0. `out` may be NULL. If the stream was removed or
/// recreated, a step that consumes nothing detaches. System calls only to wake readers.
SPLINECAST_API int splinecast_solver_step(splinecast_solver* solver, splinecast_step_result* out);

/// Sleeps until there may be work to do, but not beyond due(), the time-out or 50 ms.
SPLINECAST_API int splinecast_solver_wait(splinecast_solver* solver, int64_t timeout);

/// When step must be called next even if no item arrives; INT64_MAX: never.
SPLINECAST_API int splinecast_solver_due(splinecast_solver* solver, int64_t* time);

/// Whether it is attached; whether it continued the board of a dead solver; whether the region's
/// pages are locked into memory: 1 or 0.
SPLINECAST_API int splinecast_solver_attached(splinecast_solver* solver);
SPLINECAST_API int splinecast_solver_took_over(splinecast_solver* solver);
SPLINECAST_API int splinecast_solver_is_memory_locked(splinecast_solver* solver);

/// Writes the first refusal for each reason since this solver attached, except those that an
/// earlier call wrote, and returns their number; at most 15. Those for which there is no room are
/// left for the next call. `missed` and `consumed` are 0. May allocate.
SPLINECAST_API int splinecast_solver_first_refusals(splinecast_solver* solver,
                                                    splinecast_refusals* out);

/// Writes the first waypoint since this solver attached that was accepted although the curve
/// exceeds a limit with it. Returns 1 once; else 0, and `out` is unchanged.
SPLINECAST_API int splinecast_solver_first_excess(splinecast_solver* solver,
                                                  splinecast_limit_excess* out);

// ---------------------------------------------------------------------------------------- reader

/// The role that reads the curve, for controllers.
typedef struct splinecast_reader splinecast_reader;

/// Consecutive segments of one revision, copied by splinecast_reader_snapshot.
typedef struct splinecast_snapshot splinecast_snapshot;

/// How a reader attaches.
typedef struct splinecast_reader_options {
  size_t size;
  size_t times;   ///< sample_many allocates only for more times than this, up to 2²⁰
  int64_t owner;  ///< also trust regions of this user; −1: own user and root only
} splinecast_reader_options;
#define SPLINECAST_READER_OPTIONS_INIT \
  { sizeof(splinecast_reader_options), 0, -1 }

/// The progress of a curve, under one revision.
typedef struct splinecast_progress {
  size_t size;
  uint64_t revision;
  int64_t newest;         ///< time of the newest waypoint
  int64_t settled_until;  ///< no later revision changes the curve before this time
  uint64_t waypoints;     ///< accepted by the solver
  uint64_t refused;       ///< items that the solver refused
  int is_finished;        ///< 1: no waypoint follows
  int reserved;           ///< 0
} splinecast_progress;
#define SPLINECAST_PROGRESS_INIT \
  { sizeof(splinecast_progress), 0, 0, 0, 0, 0, 0, 0 }

/// The time law of a stream at one instant of host time.
typedef struct splinecast_law_rate {
  int64_t stream_time;  ///< rounded down
  double rate;          ///< stream time per host time
  double slope;         ///< change of the rate [1/s]
} splinecast_law_rate;

/// One segment: a polynomial in u = t − left seconds. A view into the object that it comes from.
typedef struct splinecast_segment {
  size_t size;
  int64_t left;
  int64_t right;
  int order;                       ///< coefficients per dimension
  int kind;                        ///< splinecast_segment_kind
  splinecast_matrix coefficients;  ///< [power][dimension], contiguous, lowest power first
  splinecast_vector waypoint;      ///< position of the waypoint at `left`; not given: none there
  splinecast_vector acceleration_step;  ///< a⁺ − a⁻ at `left`; not given: not known
  int is_corner;  ///< 1: the curve was cut at `left` while its time law held it, and begins
                  ///< at rest: the velocity may step there
  int reserved;   ///< 0
} splinecast_segment;
#define SPLINECAST_SEGMENT_INIT                                                       \
  {                                                                                   \
    sizeof(splinecast_segment), 0, 0, 0, 0, {NULL, 0, 0, 0, 0}, SPLINECAST_NO_VECTOR, \
        SPLINECAST_NO_VECTOR, 0, 0                                                    \
  }

/// Maps the stream's knot board; waits for it up to `timeout`. `options` NULL: the defaults. Writes
/// the handle to `out`; NULL after an error. Blocks; allocates.
SPLINECAST_API int splinecast_reader_create(const char* stream, int64_t timeout,
                                            const splinecast_reader_options* options,
                                            splinecast_reader** out);

/// Destroys a handle. NULL has no effect. System calls.
SPLINECAST_API int splinecast_reader_destroy(splinecast_reader* reader);

/// The number of dimensions: 1 to 64.
SPLINECAST_API int splinecast_reader_dimensions(splinecast_reader* reader);

/// Evaluates the curve at `t` into `out`. Returns a splinecast_sample_status; one without values
/// leaves `out` unchanged. Wait-free: no system call, no allocation. O(D) when time advances,
/// O(log n + D) after a jump. On a live stream a sample counts as executed: see
/// SPLINECAST_SAMPLE_REVISED. preview, for a time ahead, does not. On a stream that follows a time
/// law, `t` is host time, and the derivatives are those by host time; also in sample_many.
SPLINECAST_API int splinecast_reader_sample(splinecast_reader* reader, int64_t t,
                                            const splinecast_state* out);
SPLINECAST_API int splinecast_reader_preview(splinecast_reader* reader, int64_t t,
                                             const splinecast_state* out);

/// Evaluates the curve at any times, all under one revision. `values` has one row per time, with
/// [derivative, position first][dimension] in its columns; `statuses` has `status_count` bytes, one
/// splinecast_sample_status per time. A status without values leaves its row undefined. Returns 1;
/// 0 if no revision could be read: then each status says why. `revision` may be NULL. Wait-free;
/// allocates only for more times than splinecast_reader_options::times.
SPLINECAST_API int splinecast_reader_sample_many(splinecast_reader* reader,
                                                 const splinecast_times* times, int derivatives,
                                                 const splinecast_output_matrix* values,
                                                 uint8_t* statuses, size_t status_count,
                                                 uint64_t* revision);

/// The rate of the law that the stream follows, and its stream time, as the last sample or preview
/// saw them. Of a stream without a law: rate 1, stream time 0.
SPLINECAST_API int splinecast_reader_rate(splinecast_reader* reader, splinecast_law_rate* out);

/// The settled time of the curve that the last sample used; before the first one, the earliest time
/// that a curve can have.
SPLINECAST_API int splinecast_reader_settled_until(splinecast_reader* reader, int64_t* time);

/// Copies every segment that overlaps the closed interval, all under one revision. Returns a
/// splinecast_sample_status for the whole; one without values leaves no segments. Allocates if
/// `out` must grow.
SPLINECAST_API int splinecast_reader_snapshot(splinecast_reader* reader, int64_t from, int64_t to,
                                              splinecast_snapshot* out);

/// The stream's limits: vectors of one value per dimension, which are valid as long as the reader;
/// not given where there is no limit.
SPLINECAST_API int splinecast_reader_limits(splinecast_reader* reader, splinecast_limits* out);

/// Compares a sample with the stream's limits. All four derivatives must be given. O(D).
SPLINECAST_API int splinecast_reader_excess(splinecast_reader* reader,
                                            const splinecast_state* sampled,
                                            splinecast_excess* out);

/// The progress of the curve; the time of the oldest knot that the board keeps. Return 1; 0 if
/// there is no revision yet or the writer overtook every try.
SPLINECAST_API int splinecast_reader_progress(splinecast_reader* reader, splinecast_progress* out);
SPLINECAST_API int splinecast_reader_first_time(splinecast_reader* reader, int64_t* time);

/// Sleeps until there is a revision that this reader has not seen. Returns a
/// splinecast_wait_status. Blocks.
SPLINECAST_API int splinecast_reader_wait(splinecast_reader* reader, int64_t timeout);

/// Which writers live: a sum of these. System calls: not for a control loop.
enum { SPLINECAST_PRODUCER_ALIVE = 1, SPLINECAST_SOLVER_ALIVE = 2 };
SPLINECAST_API int splinecast_reader_alive(splinecast_reader* reader);

/// The stream's splinecast_clock.
SPLINECAST_API int splinecast_reader_clock(splinecast_reader* reader);

/// Name and unit of a dimension; "" if it has none. Valid as long as the reader; NULL after an
/// error.
SPLINECAST_API const char* splinecast_reader_name(splinecast_reader* reader, size_t dimension);
SPLINECAST_API const char* splinecast_reader_unit(splinecast_reader* reader, size_t dimension);

/// The kind of a dimension, and its text: "linear", "periodic:6.28". The text is valid as long as
/// the reader; NULL after an error.
SPLINECAST_API int splinecast_reader_kind(splinecast_reader* reader, size_t dimension,
                                          splinecast_dimension* out);
SPLINECAST_API const char* splinecast_reader_kind_text(splinecast_reader* reader, size_t dimension);

/// Whether the region's pages are locked into memory: 1 or 0.
SPLINECAST_API int splinecast_reader_is_memory_locked(splinecast_reader* reader);

/// Creates an empty snapshot for streams of this many dimensions. Allocates.
SPLINECAST_API int splinecast_snapshot_create(size_t dimensions, splinecast_snapshot** out);

/// Destroys a handle. NULL has no effect.
SPLINECAST_API int splinecast_snapshot_destroy(splinecast_snapshot* snapshot);

/// The number of segments; the revision that all belong to, 0: none; the time before which no later
/// revision changes the curve.
SPLINECAST_API int splinecast_snapshot_segments(splinecast_snapshot* snapshot, size_t* segments);
SPLINECAST_API int splinecast_snapshot_revision(splinecast_snapshot* snapshot, uint64_t* revision);
SPLINECAST_API int splinecast_snapshot_settled_until(splinecast_snapshot* snapshot, int64_t* time);

/// Segment i, oldest first. Valid until the snapshot is written again or destroyed. O(1).
SPLINECAST_API int splinecast_snapshot_segment(splinecast_snapshot* snapshot, size_t i,
                                               splinecast_segment* out);

// -------------------------------------------------------------------------------- rate commander

/// Requests the rate of a time law. A law maps host time to the stream time of all streams that
/// follow it; its rate is stream time per host time, the least that its commanders request. Its
/// solver creates the law when the first commander appears. When a commander ends, its last request
/// remains in force until a commander of the same name makes another one, or until its dead man
/// expires.
typedef struct splinecast_rate_commander splinecast_rate_commander;

/// Access to the commander's files.
typedef struct splinecast_rate_commander_options {
  size_t size;
  int64_t group;      ///< group of the regions; −1: this process's
  int64_t owner;      ///< also trust regions of this user; −1: own user and root only
  uint32_t mode;      ///< permission bits of the regions, up to 0777
  uint32_t reserved;  ///< 0
} splinecast_rate_commander_options;
#define SPLINECAST_RATE_COMMANDER_OPTIONS_INIT \
  { sizeof(splinecast_rate_commander_options), -1, -1, 0600, 0 }

/// Becomes the commander of this name; it requests nothing until its first call, unless an earlier
/// commander of that name did. BUSY if the law has a living commander of that name. `options` NULL:
/// the defaults. Writes the handle to `out`; NULL after an error. System calls; allocates.
SPLINECAST_API int splinecast_rate_commander_create(
    const char* law, const char* commander, const splinecast_rate_commander_options* options,
    splinecast_rate_commander** out);

/// Destroys a handle; its last request remains in force. NULL has no effect. System calls.
SPLINECAST_API int splinecast_rate_commander_destroy(splinecast_rate_commander* commander);

/// Requests a rate of 0 to 100, reached by a ramp of this length: 1 ms to 1 h. A rate above the
/// law's largest gives ARGUMENT; it counts as the largest while no solver has begun the law. hold
/// requests rate 0. release withdraws the request: the law has the least of the others, or 1 if
/// there is none. Does not wait for the solver. Three system calls.
SPLINECAST_API int splinecast_rate_commander_set_rate(splinecast_rate_commander* commander,
                                                      double rate, int64_t ramp);
SPLINECAST_API int splinecast_rate_commander_hold(splinecast_rate_commander* commander,
                                                  int64_t ramp);
SPLINECAST_API int splinecast_rate_commander_release(splinecast_rate_commander* commander,
                                                     int64_t ramp);

/// From the next request on, the law holds if this commander does not renew its request within
/// `timeout`, 1 ms to 1 h, or 0: never; `ramp`, 1 ms to 1 h, is the length of the ramp of that
/// hold, which lasts until the next request. renew renews the last request; returns 1, and does
/// nothing, if its dead man has fired. Three system calls.
SPLINECAST_API int splinecast_rate_commander_set_dead_man(splinecast_rate_commander* commander,
                                                          int64_t timeout, int64_t ramp);
SPLINECAST_API int splinecast_rate_commander_renew(splinecast_rate_commander* commander);

/// The number of the last request that this handle made; 0: none yet. wait_in_force waits until the
/// law's solver has committed the request of this number, or a later one; its ramp then begins
/// within the solver's freeze-ahead. Returns 1, or 0 if it has not after `timeout`: the request
/// remains.
SPLINECAST_API int splinecast_rate_commander_number(splinecast_rate_commander* commander,
                                                    uint64_t* number);
SPLINECAST_API int splinecast_rate_commander_wait_in_force(splinecast_rate_commander* commander,
                                                           uint64_t number, int64_t timeout);

// --------------------------------------------------------------------------------------- stopper

/// Stops a live stream from any process: a latched stop. The next step of the solver begins a stop
/// at the settled time, and then refuses waypoints, start states and replacements as `stopped`
/// until all stoppers of the stream have released it. The request stays in force when the handle or
/// its process ends, when the solver ends, and when the stream is created again. It may be made
/// before there is a stream. It is not a safety function.
typedef struct splinecast_stopper splinecast_stopper;

/// Access to the stopper's files.
typedef struct splinecast_stopper_options {
  size_t size;
  int64_t group;      ///< group of the regions; −1: this process's
  int64_t owner;      ///< also trust regions of this user; −1: own user and root only
  uint32_t mode;      ///< permission bits of the regions, up to 0777
  uint32_t reserved;  ///< 0
} splinecast_stopper_options;
#define SPLINECAST_STOPPER_OPTIONS_INIT \
  { sizeof(splinecast_stopper_options), -1, -1, 0600, 0 }

/// Becomes the stopper of this name; it requests nothing until its first call, unless an earlier
/// stopper of that name did. BUSY if the stream has a living stopper of that name. `options` NULL:
/// the defaults. Writes the handle to `out`; NULL after an error. System calls; allocates.
SPLINECAST_API int splinecast_stopper_create(const char* stream, const char* stopper,
                                             const splinecast_stopper_options* options,
                                             splinecast_stopper** out);

/// Destroys a handle; does not release the stream. NULL has no effect. System calls.
SPLINECAST_API int splinecast_stopper_destroy(splinecast_stopper* stopper);

/// stop requests that the stream stop, and stay; release withdraws that. Neither waits for the
/// solver, and both do nothing if that is requested already. Two system calls.
SPLINECAST_API int splinecast_stopper_stop(splinecast_stopper* stopper);
SPLINECAST_API int splinecast_stopper_release(splinecast_stopper* stopper);

/// Returns 1 if this stopper, or an earlier one of its name, requests the stop; else 0.
SPLINECAST_API int splinecast_stopper_is_latched(splinecast_stopper* stopper);

/// The number of the last request of this handle; 0: none yet. wait_in_force waits until the
/// stream's solver has committed the request of this number, or a later one. Returns 1, or 0 if it
/// has not after `timeout`: the request remains. 1 also if the stream has been finished before: its
/// last motion is not stopped.
SPLINECAST_API int splinecast_stopper_number(splinecast_stopper* stopper, uint64_t* number);
SPLINECAST_API int splinecast_stopper_wait_in_force(splinecast_stopper* stopper, uint64_t number,
                                                    int64_t timeout);

// ------------------------------------------------------------------------------------- batch fit

/// A curve through all waypoints at once. Never changes: several threads may use it.
typedef struct splinecast_curve splinecast_curve;

/// Options of a fit.
typedef struct splinecast_fit_options {
  size_t size;
  const char* method;  ///< its name; NULL: "c2"
  double lambda;       ///< of smoothing: 0 to 1e100 s³
  double time_scale;   ///< of rounded: above 0, at most 1e100 s
  splinecast_condition start;
  splinecast_condition end;
} splinecast_fit_options;
#define SPLINECAST_FIT_OPTIONS_INIT                                                       \
  {                                                                                       \
    sizeof(splinecast_fit_options), NULL, 0, 1, {SPLINECAST_OWN, SPLINECAST_NO_VECTOR}, { \
      SPLINECAST_OWN, SPLINECAST_NO_VECTOR                                                \
    }                                                                                     \
  }

/// Fits a curve. Needs at least one waypoint, 1 to 64 dimensions, increasing times and values
/// within ±1e100. `options` NULL: the defaults. Writes the handle to `out`; NULL after an error.
/// O(n·D); allocates.
SPLINECAST_API int splinecast_fit(const splinecast_waypoints* waypoints,
                                  const splinecast_fit_options* options, splinecast_curve** out);

/// Writes the λ that generalised cross-validation chooses for `smoothing`. O(n·D); allocates.
SPLINECAST_API int splinecast_cross_validated_lambda(const splinecast_waypoints* waypoints,
                                                     double* lambda);

/// Destroys a handle. NULL has no effect.
SPLINECAST_API int splinecast_curve_destroy(splinecast_curve* curve);

/// The number of dimensions: 1 to 64.
SPLINECAST_API int splinecast_curve_dimensions(const splinecast_curve* curve);

/// The number of segments.
SPLINECAST_API int splinecast_curve_segments(const splinecast_curve* curve, size_t* segments);

/// Segment i, which is valid as long as the curve. It has no waypoint and no acceleration step.
SPLINECAST_API int splinecast_curve_segment(const splinecast_curve* curve, size_t i,
                                            splinecast_segment* out);

/// Evaluates at a time between the first and the last break. O(log n + D).
SPLINECAST_API int splinecast_curve_evaluate(const splinecast_curve* curve, int64_t t,
                                             const splinecast_state* out);

/// Evaluates the r-th derivative, r from 0 to 15: one value per dimension.
SPLINECAST_API int splinecast_curve_derivative(const splinecast_curve* curve, int64_t t, int r,
                                               const splinecast_output* out);

#ifdef __cplusplus
}
#endif

#endif
