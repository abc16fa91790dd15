// In C: appends a live motion, solves it in the same thread, samples it, leaves it for a new path,
// and fits the same path at once.
//
//   8_producer [STREAM]      default: arm
//
// Needs no other process.

#include <math.h>
#include <stdio.h>

#include <splinecast.h>

enum { kDimensions = 2, kWaypoints = 50 };
static const int64_t kInterval = 10000000;  // ns
static const int64_t kLead = 200000000;     // at least freeze-ahead (5 ms) and K + 1 (9) intervals
static const int64_t kNotice = 50000000;    // from the decision to leave the path until it is left
static const int64_t kPatience = 1000000000;

// The path: a quarter of a circle with a radius of 0.3 m, from rest to rest.
static void quarter(double u, double radius, double position[kDimensions]) {
  const double angle = 1.5707963267948966 * u * u * u * (10 - 15 * u + 6 * u * u);
  position[0] = radius * cos(angle);
  position[1] = radius * sin(angle);
}

// Prints why a call has failed.
static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, splinecast_last_error());
  return 1;
}

// Steps whenever the solver has work, until `end`.
static int solve_until(splinecast_solver* solver, int64_t end) {
  while (splinecast_now() < end) {
    int again = splinecast_solver_step(solver, NULL);
    while (again > 0) again = splinecast_solver_step(solver, NULL);
    if (again < 0) return again;
    splinecast_solver_wait(solver, end - splinecast_now());  // returns when the solver is due
  }
  return 0;
}

// Appends the waypoints, each `kLead` before its time, and solves meanwhile.
static int produce(splinecast_producer* producer, splinecast_solver* solver, int64_t begin) {
  for (int i = 0; i <= kWaypoints; ++i) {
    const int64_t t = begin + i * kInterval;
    if (solve_until(solver, t - kLead) < 0) return failed("step");
    double position[kDimensions];
    quarter((double)i / kWaypoints, 0.3, position);
    const splinecast_waypoint waypoint = {.time = t, .position = {position, kDimensions, 1}};
    const int status = splinecast_producer_append(producer, &waypoint);
    if (status < 0) return failed("append");
    if (status != SPLINECAST_APPEND_ACCEPTED) {
      fprintf(stderr, "waypoint refused: %s\n", splinecast_append_text(status));
    }
  }
  return 0;
}

// What remains after `t` of a path of half the radius.
static splinecast_waypoints inner_path(int64_t begin, int64_t t, int64_t* times,
                                       double* positions) {
  size_t count = 0;
  for (int i = 0; i <= kWaypoints; ++i) {
    const int64_t time = begin + i * kInterval;
    if (time <= t) continue;
    times[count] = time;
    quarter((double)i / kWaypoints, 0.15, positions + count * kDimensions);
    ++count;
  }
  const splinecast_waypoints path = {.times = {times, count, 1},
                                     .positions = {positions, count, kDimensions, 0, 0}};
  return path;
}

// Leaves the motion for another path: prints what that would do, then does it.
static int leave(splinecast_producer* producer, int64_t begin) {
  int64_t times[kWaypoints + 1];
  double positions[(kWaypoints + 1) * kDimensions];
  const int64_t t = splinecast_now() + kNotice;
  const splinecast_waypoints path = inner_path(begin, t, times, positions);
  double acceleration[kDimensions];
  splinecast_preview preview = SPLINECAST_PREVIEW_INIT;
  preview.entry_acceleration = (splinecast_output){acceleration, kDimensions, 1};
  if (splinecast_producer_preview_replace(producer, t, &path, kNotice, &preview) < 0) {
    return failed("preview");
  }
  if (preview.is_known) {
    printf("the entry takes %g ms and at most %.2g m/s2 in y\n", (double)preview.duration * 1e-6,
           acceleration[1]);
  }
  const int status = splinecast_producer_replace_from(producer, t, &path, kNotice);
  if (status < 0) return failed("replace");
  printf("replacement %s\n", splinecast_append_text(status));
  return 0;
}

// Samples the stream until it is at rest: a control loop of 1 kHz.
static int follow(splinecast_reader* reader, splinecast_solver* solver, int64_t until) {
  double position[kDimensions];
  double velocity[kDimensions];
  const splinecast_state state = {.position = {position, kDimensions, 1},
                                  .velocity = {velocity, kDimensions, 1}};
  double fastest = 0;
  for (int64_t t = splinecast_now(); t < until; t += 1000000) {
    if (solve_until(solver, t) < 0) return failed("step");
    const int status = splinecast_reader_sample(reader, t, &state);
    if (status < 0) return failed("sample");
    if (splinecast_has_values(status)) fastest = fmax(fastest, hypot(velocity[0], velocity[1]));
  }
  printf("at rest at %.3f, %.3f m; fastest %.2f m/s\n", position[0], position[1], fastest);
  return 0;
}

// Ends the stream at its last waypoint, at rest.
static int finish(splinecast_producer* producer) {
  const splinecast_condition end = {.kind = SPLINECAST_HALT};
  const int status = splinecast_producer_finish(producer, &end);
  return status == SPLINECAST_APPEND_ACCEPTED ? 0 : failed("finish");
}

// Prints how many waypoints the solver has refused.
static int print_refusals(splinecast_producer* producer) {
  splinecast_refusal items[4];
  splinecast_refusals refused = SPLINECAST_REFUSALS_INIT;
  refused.items = items;
  refused.capacity = 4;
  const int count = splinecast_producer_refusals(producer, &refused);
  if (count < 0) return failed("refusals");
  printf("%d refused\n", count);
  return 0;
}

// Fits a curve through a whole path at once and evaluates it in its middle.
static int fit_at_once(void) {
  int64_t times[kWaypoints + 1];
  double positions[(kWaypoints + 1) * kDimensions];
  const splinecast_waypoints path = inner_path(0, -1, times, positions);
  splinecast_fit_options options = SPLINECAST_FIT_OPTIONS_INIT;
  options.start.kind = options.end.kind = SPLINECAST_CLAMPED;
  splinecast_curve* curve = NULL;
  if (splinecast_fit(&path, &options, &curve) < 0) return failed("fit");
  double position[kDimensions];
  const splinecast_state state = {.position = {position, kDimensions, 1}};
  const int result = splinecast_curve_evaluate(curve, kWaypoints * kInterval / 2, &state);
  splinecast_curve_destroy(curve);
  if (result < 0) return failed("evaluate");
  printf("the fit passes %.3f, %.3f m\n", position[0], position[1]);
  return 0;
}

// Creates the stream and the first two of its roles.
static int create(const char* stream, splinecast_producer** producer, splinecast_solver** solver) {
  const char* const names[kDimensions] = {"x", "y"};
  const char* const units[kDimensions] = {"m", "m"};
  splinecast_producer_options options = SPLINECAST_PRODUCER_OPTIONS_INIT;
  options.dimensions = kDimensions;
  options.names = names;
  options.name_count = kDimensions;
  options.units = units;
  options.unit_count = kDimensions;
  if (splinecast_producer_create(stream, &options, producer) < 0) return failed(stream);
  if (splinecast_solver_create(stream, NULL, solver) < 0) return failed(stream);
  int attached = splinecast_solver_attach(*solver);
  while (attached == 0) {  // an earlier curve of that name may still move
    splinecast_solver_wait(*solver, kPatience);
    attached = splinecast_solver_attach(*solver);
  }
  return attached < 0 ? failed(stream) : 0;
}

// The whole motion, with handles that exist.
static int move(splinecast_producer* producer, splinecast_solver* solver,
                splinecast_reader* reader) {
  const int64_t begin = splinecast_now() + kLead;
  if (produce(producer, solver, begin) != 0) return 1;
  if (leave(producer, begin) != 0) return 1;
  if (finish(producer) != 0) return 1;
  if (follow(reader, solver, begin + kWaypoints * kInterval + kLead) != 0) return 1;
  return print_refusals(producer);
}

int main(int argc, char** argv) {
  const char* stream = argc > 1 ? argv[1] : "arm";
  splinecast_producer* producer = NULL;
  splinecast_solver* solver = NULL;
  splinecast_reader* reader = NULL;
  int result = create(stream, &producer, &solver);
  if (result == 0 && splinecast_reader_create(stream, kPatience, NULL, &reader) < 0) {
    result = failed(stream);
  }
  if (result == 0) result = move(producer, solver, reader);
  if (result == 0) result = fit_at_once();
  splinecast_reader_destroy(reader);
  splinecast_solver_destroy(solver);
  splinecast_producer_destroy(producer);
  return result;
}
