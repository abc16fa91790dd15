#include <string>

#include "ipc/arguments/options.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/c/roles.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

constexpr WaypointNames kWaypoint{"waypoint", "waypoint->position", "waypoint->velocity",
                                  "waypoint->acceleration"};
constexpr WaypointNames kFirst{"first", "first->position", "first->velocity",
                               "first->acceleration"};
constexpr WaypointNames kState{"state", "state->position", "state->velocity",
                               "state->acceleration"};

/// Runs the body of a function with the producer of a handle.
template <typename Body>
int with(splinecast_producer* producer, const Body& body) noexcept {
  return guarded([&] { return body(require_producer(producer)); });
}

int number(AppendStatus status) noexcept { return static_cast<int>(status); }

Instant instant_of(const Waypoint& state) noexcept {
  return {.time = state.time,
          .position = state.position,
          .velocity = state.velocity,
          .acceleration = state.acceleration};
}

/// Writes an outcome. Returns its kind.
int put(const ItemOutcome& found, splinecast_outcome* out) {
  splinecast_outcome filled = read_struct(out, SPLINECAST_OUTCOME_INIT, "out");
  filled.kind = static_cast<int>(found.kind);
  filled.way = static_cast<int>(found.way);
  filled.reason = static_cast<int>(found.reason);
  filled.is_final = found.is_final ? 1 : 0;
  filled.time = found.time.value_or(Time::zero()).count();
  write_struct(filled, out);
  return filled.kind;
}

}  // namespace

extern "C" {

int splinecast_producer_create(const char* stream, const splinecast_producer_options* options,
                               splinecast_producer** out) {
  return create_handle(out, [&] {
    return new splinecast_producer(std::string(require_text(stream, "stream")),
                                   producer_options(options));
  });
}

int splinecast_producer_destroy(splinecast_producer* producer) {
  return destroy_handle(producer, "producer");
}

int splinecast_producer_append(splinecast_producer* producer, const splinecast_waypoint* waypoint) {
  return with(producer, [&](splinecast_producer& own) {
    const WaypointView view(waypoint, own.dimensions, kWaypoint);
    return number(own.producer.append(view.waypoint()));
  });
}

int splinecast_producer_append_many(splinecast_producer* producer,
                                    const splinecast_waypoints* waypoints, size_t* appended) {
  return with(producer, [&](splinecast_producer& own) {
    const Columns columns = require_columns(waypoints, own.dimensions);
    if (appended != nullptr) require_pointer(appended, "appended");
    AppendStatus status = AppendStatus::accepted;
    std::size_t count = 0;
    WaypointList::for_each(columns, [&](const Waypoint& waypoint) {
      status = own.producer.append(waypoint);
      if (status == AppendStatus::accepted) ++count;
      return status == AppendStatus::accepted;
    });
    if (appended != nullptr) *appended = count;
    return number(status);
  });
}

int splinecast_producer_replace_from(splinecast_producer* producer, int64_t t,
                                     const splinecast_waypoints* waypoints, int64_t blend) {
  return with(producer, [&](splinecast_producer& own) {
    const auto list = own.waypoints.replacement(waypoints, own.dimensions);
    if (!list) return number(AppendStatus::too_many);
    return number(own.producer.replace_from(Time(t), *list, {.blend = Time(blend)}));
  });
}

int splinecast_producer_start_from(splinecast_producer* producer,
                                   const splinecast_waypoint* state) {
  return with(producer, [&](splinecast_producer& own) {
    const WaypointView view(state, own.dimensions, kState);
    require_pointer(state->velocity.data, kState.velocity);
    require_pointer(state->acceleration.data, kState.acceleration);
    return number(own.producer.start_from(instant_of(view.waypoint())));
  });
}

int splinecast_producer_start_moved(splinecast_producer* producer,
                                    const splinecast_waypoint* state) {
  return with(producer, [&](splinecast_producer& own) {
    const WaypointView view(state, own.dimensions, kState);
    return number(own.producer.start_from(instant_of(view.waypoint()), {.moved = true}));
  });
}

int splinecast_producer_old_end(splinecast_producer* producer, int64_t* time,
                                const splinecast_output* position) {
  return with(producer, [&](splinecast_producer& own) {
    std::int64_t* const at = require_pointer(time, "time");
    const Outputs out =
        require_output(*require_pointer(position, "position"), own.dimensions, "position");
    const Instant end = own.producer.old_end();
    if (end.position.empty()) return 0;
    *at = end.time.count();
    for (std::size_t d = 0; d < own.dimensions; ++d) out[d] = end.position[d];
    return 1;
  });
}

int splinecast_producer_elsewhere_message(splinecast_producer* producer,
                                          const splinecast_waypoint* first, char* text,
                                          size_t capacity) {
  return with(producer, [&](splinecast_producer& own) {
    const WaypointView view(first, own.dimensions, kFirst);
    return put_text(own.producer.why_elsewhere(view.waypoint()), text, capacity);
  });
}

int splinecast_producer_stopped_by(splinecast_producer* producer, char* text, size_t capacity) {
  return with(producer, [&](splinecast_producer& own) {
    std::string names;
    for (const std::string& name : own.producer.stopped_by()) {
      names.append(names.empty() ? "" : ", ").append(name);
    }
    return put_text(names, text, capacity);
  });
}

int splinecast_producer_finish(splinecast_producer* producer, const splinecast_condition* end) {
  return with(producer, [&](splinecast_producer& own) {
    if (end == nullptr) {
      return number(own.producer.finish({.kind = ConditionKind::halt, .value = {}}));
    }
    return number(
        own.producer.finish(condition(*require_pointer(end, "end"), own.dimensions, "end")));
  });
}

int splinecast_producer_refusals(splinecast_producer* producer, splinecast_refusals* out) {
  return with(producer, [&](splinecast_producer& own) {
    return own.refused.deliver(out, [&](Refusals& found) { own.producer.refusals(found); });
  });
}

int splinecast_producer_last_item(splinecast_producer* producer, uint64_t* item) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(item, "item") = own.producer.last_item();
    return 0;
  });
}

int splinecast_producer_outcome(splinecast_producer* producer, uint64_t item,
                                splinecast_outcome* out) {
  return with(producer,
              [&](splinecast_producer& own) { return put(own.producer.outcome(item), out); });
}

int splinecast_producer_wait_outcome(splinecast_producer* producer, uint64_t item, int64_t timeout,
                                     splinecast_outcome* out) {
  return with(producer, [&](splinecast_producer& own) {
    return put(own.producer.wait_outcome(item, timeout_of(timeout)), out);
  });
}

int splinecast_producer_wait_for_solver(splinecast_producer* producer, int64_t timeout) {
  return with(producer, [&](splinecast_producer& own) -> int {
    return own.producer.wait_for_solver(timeout_of(timeout));
  });
}

int splinecast_producer_wait_for_room(splinecast_producer* producer, int64_t timeout) {
  return with(producer, [&](splinecast_producer& own) -> int {
    return own.producer.wait_for_room(timeout_of(timeout));
  });
}

int splinecast_producer_wait_until_consumed(splinecast_producer* producer, int64_t timeout) {
  return with(producer, [&](splinecast_producer& own) -> int {
    return own.producer.wait_until_consumed(timeout_of(timeout));
  });
}

int splinecast_producer_solver_alive(splinecast_producer* producer) {
  return with(producer,
              [](splinecast_producer& own) -> int { return own.producer.solver_alive(); });
}

int splinecast_producer_replacement_begin(splinecast_producer* producer, int64_t* begin,
                                          int* from_rest) {
  return with(producer, [&](splinecast_producer& own) {
    require_pointer(begin, "begin");
    require_pointer(from_rest, "from_rest");
    const std::optional<ReplacementBegin> found = own.producer.replacement_begin();
    if (!found) return 0;
    *begin = found->begin.count();
    *from_rest = found->from_rest ? 1 : 0;
    return 1;
  });
}

int splinecast_producer_earliest(splinecast_producer* producer, int64_t* time) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(time, "time") = own.producer.earliest().count();
    return 0;
  });
}

int splinecast_producer_now(splinecast_producer* producer, int64_t* time) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(time, "time") = own.producer.now().count();
    return 0;
  });
}

int splinecast_producer_last_time(splinecast_producer* producer, int64_t* time) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(time, "time") = own.producer.last_time().count();
    return 0;
  });
}

int splinecast_producer_appended(splinecast_producer* producer, uint64_t* items) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(items, "items") = own.producer.appended();
    return 0;
  });
}

int splinecast_producer_consumed(splinecast_producer* producer, uint64_t* items) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(items, "items") = own.producer.consumed();
    return 0;
  });
}

int splinecast_producer_stream_id(splinecast_producer* producer, uint64_t* id) {
  return with(producer, [&](splinecast_producer& own) {
    *require_pointer(id, "id") = own.producer.stream_id();
    return 0;
  });
}

int splinecast_producer_continues(splinecast_producer* producer) {
  return with(producer, [](splinecast_producer& own) -> int { return own.producer.continues(); });
}

int splinecast_producer_is_memory_locked(splinecast_producer* producer) {
  return with(producer,
              [](splinecast_producer& own) -> int { return own.producer.is_memory_locked(); });
}

int splinecast_producer_withdraw(splinecast_producer* producer) {
  return with(producer, [](splinecast_producer& own) {
    own.producer.withdraw();
    own.is_withdrawn = true;
    return 0;
  });
}

}  // extern "C"
