#include "tests/ipc/c/every_pointer.hpp"

/// The pointers of general functions and of producers.
namespace splinecast::testing {

void CPointers::add_general() {
  wrong_.text("splinecast_remove", "stream", [](auto* p) { return splinecast_remove(p); });
  wrong_.pointer<const splinecast_refusal>(
      "splinecast_refusal_message", "refusal",
      [this](auto* p) { return splinecast_refusal_message(p, text_.data(), 10); });
  wrong_.pointer<char>("splinecast_refusal_message", "text",
                       [this](auto* p) { return splinecast_refusal_message(&refusal_, p, 10); });
  wrong_.pointer<const splinecast_limit_excess>(
      "splinecast_excess_message", "excess",
      [this](auto* p) { return splinecast_excess_message(p, nullptr, text_.data(), 10); });
  wrong_.text(
      "splinecast_excess_message", "name",
      [this](auto* p) { return splinecast_excess_message(&excess_, p, text_.data(), 10); },
      WrongPointers::Null::allowed);
  wrong_.pointer<char>("splinecast_excess_message", "text", [this](auto* p) {
    return splinecast_excess_message(&excess_, nullptr, p, 10);
  });
  wrong_.pointer<char>("splinecast_time_message", "text",
                       [](auto* p) { return splinecast_time_message(0, p, 10); });
}

void CPointers::add_producer() {
  const char* create = "splinecast_producer_create";
  wrong_.text(create, "stream", [](auto* p) {
    splinecast_producer* out = nullptr;
    return splinecast_producer_create(p, nullptr, &out);
  });
  wrong_.pointer<const splinecast_producer_options>(
      create, "options",
      [](auto* p) {
        splinecast_producer* out = nullptr;
        return splinecast_producer_create("c.pointers", p, &out);
      },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_producer*>(
      create, "out", [](auto* p) { return splinecast_producer_create("c.pointers", nullptr, p); });
  wrong_.handle<splinecast_producer>(
      "splinecast_producer_destroy", "producer",
      [](auto* p) { return splinecast_producer_destroy(p); }, c_.solver,
      WrongPointers::Null::allowed);
  producer("splinecast_producer_append",
           [this](auto* p) { return splinecast_producer_append(p, &waypoint_); });
  wrong_.pointer<const splinecast_waypoint>(
      "splinecast_producer_append", "waypoint",
      [this](auto* p) { return splinecast_producer_append(c_.producer, p); });
  producer("splinecast_producer_append_many",
           [this](auto* p) { return splinecast_producer_append_many(p, &path_, nullptr); });
  wrong_.pointer<const splinecast_waypoints>(
      "splinecast_producer_append_many", "waypoints",
      [this](auto* p) { return splinecast_producer_append_many(c_.producer, p, nullptr); });
  wrong_.pointer<size_t>(
      "splinecast_producer_append_many", "appended",
      [this](auto* p) { return splinecast_producer_append_many(c_.producer, &path_, p); },
      WrongPointers::Null::allowed);
}

void CPointers::add_replacement() {
  producer("splinecast_producer_replace_from",
           [this](auto* p) { return splinecast_producer_replace_from(p, 0, &path_, 0); });
  wrong_.pointer<const splinecast_waypoints>(
      "splinecast_producer_replace_from", "waypoints",
      [this](auto* p) { return splinecast_producer_replace_from(c_.producer, 0, p, 0); },
      WrongPointers::Null::allowed);
  producer("splinecast_producer_start_from",
           [this](auto* p) { return splinecast_producer_start_from(p, &waypoint_); });
  wrong_.pointer<const splinecast_waypoint>(
      "splinecast_producer_start_from", "state",
      [this](auto* p) { return splinecast_producer_start_from(c_.producer, p); });
  producer("splinecast_producer_start_moved",
           [this](auto* p) { return splinecast_producer_start_moved(p, &waypoint_); });
  wrong_.pointer<const splinecast_waypoint>(
      "splinecast_producer_start_moved", "state",
      [this](auto* p) { return splinecast_producer_start_moved(c_.producer, p); });
  add_old_end();
  producer("splinecast_producer_finish",
           [](auto* p) { return splinecast_producer_finish(p, nullptr); });
  wrong_.pointer<const splinecast_condition>(
      "splinecast_producer_finish", "end",
      [this](auto* p) { return splinecast_producer_finish(c_.producer, p); },
      WrongPointers::Null::allowed);
}

void CPointers::add_old_end() {
  const char* end = "splinecast_producer_old_end";
  producer(end, [this](auto* p) { return splinecast_producer_old_end(p, &time_, &output_); });
  wrong_.pointer<std::int64_t>(end, "time", [this](auto* p) {
    return splinecast_producer_old_end(c_.producer, p, &output_);
  });
  wrong_.pointer<const splinecast_output>(end, "position", [this](auto* p) {
    return splinecast_producer_old_end(c_.producer, &time_, p);
  });
  const char* message = "splinecast_producer_elsewhere_message";
  producer(message, [this](auto* p) {
    return splinecast_producer_elsewhere_message(p, &waypoint_, text_.data(), 10);
  });
  wrong_.pointer<const splinecast_waypoint>(message, "first", [this](auto* p) {
    return splinecast_producer_elsewhere_message(c_.producer, p, text_.data(), 10);
  });
  wrong_.pointer<char>(message, "text", [this](auto* p) {
    return splinecast_producer_elsewhere_message(c_.producer, &waypoint_, p, 10);
  });
  const char* stopped = "splinecast_producer_stopped_by";
  producer(stopped,
           [this](auto* p) { return splinecast_producer_stopped_by(p, text_.data(), 10); });
  wrong_.pointer<char>(stopped, "text", [this](auto* p) {
    return splinecast_producer_stopped_by(c_.producer, p, 10);
  });
}

void CPointers::add_producer_outputs() {
  const char* preview = "splinecast_producer_preview_replace";
  producer(preview, [this](auto* p) {
    return splinecast_producer_preview_replace(p, 0, nullptr, 0, &preview_);
  });
  wrong_.pointer<const splinecast_waypoints>(
      preview, "waypoints",
      [this](auto* p) {
        return splinecast_producer_preview_replace(c_.producer, 0, p, 0, &preview_);
      },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_preview>(preview, "out", [this](auto* p) {
    return splinecast_producer_preview_replace(c_.producer, 0, nullptr, 0, p);
  });
  producer("splinecast_producer_refusals", [](auto* p) {
    splinecast_refusals out = SPLINECAST_REFUSALS_INIT;
    return splinecast_producer_refusals(p, &out);
  });
  wrong_.pointer<splinecast_refusals>("splinecast_producer_refusals", "out", [this](auto* p) {
    return splinecast_producer_refusals(c_.producer, p);
  });
}

void CPointers::add_outcomes() {
  producer("splinecast_producer_outcome",
           [this](auto* p) { return splinecast_producer_outcome(p, 0, &outcome_); });
  wrong_.pointer<splinecast_outcome>("splinecast_producer_outcome", "out", [this](auto* p) {
    return splinecast_producer_outcome(c_.producer, 0, p);
  });
  producer("splinecast_producer_wait_outcome",
           [this](auto* p) { return splinecast_producer_wait_outcome(p, 0, 0, &outcome_); });
  wrong_.pointer<splinecast_outcome>("splinecast_producer_wait_outcome", "out", [this](auto* p) {
    return splinecast_producer_wait_outcome(c_.producer, 0, 0, p);
  });
  HANDLE_AND_OUTPUT(producer, uint64_t, splinecast_producer_last_item, "item", c_.producer,
                    number_);
}

void CPointers::add_producer_state() {
  add_outcomes();
  HANDLE_ONLY(producer, splinecast_producer_wait_for_solver, , 0);
  HANDLE_ONLY(producer, splinecast_producer_wait_for_room, , 0);
  HANDLE_ONLY(producer, splinecast_producer_wait_until_consumed, , 0);
  HANDLE_ONLY(producer, splinecast_producer_solver_alive);
  HANDLE_ONLY(producer, splinecast_producer_continues);
  HANDLE_ONLY(producer, splinecast_producer_is_memory_locked);
  HANDLE_ONLY(producer, splinecast_producer_withdraw);
  HANDLE_AND_OUTPUT(producer, std::int64_t, splinecast_producer_earliest, "time", c_.producer,
                    time_);
  producer("splinecast_producer_replacement_begin", [this](auto* p) {
    int from_rest = 0;
    return splinecast_producer_replacement_begin(p, &time_, &from_rest);
  });
  wrong_.pointer<std::int64_t>("splinecast_producer_replacement_begin", "begin", [this](auto* p) {
    int from_rest = 0;
    return splinecast_producer_replacement_begin(c_.producer, p, &from_rest);
  });
  wrong_.pointer<int>("splinecast_producer_replacement_begin", "from_rest", [this](auto* p) {
    return splinecast_producer_replacement_begin(c_.producer, &time_, p);
  });
  HANDLE_AND_OUTPUT(producer, std::int64_t, splinecast_producer_now, "time", c_.producer, time_);
  HANDLE_AND_OUTPUT(producer, std::int64_t, splinecast_producer_last_time, "time", c_.producer,
                    time_);
  HANDLE_AND_OUTPUT(producer, uint64_t, splinecast_producer_appended, "items", c_.producer,
                    number_);
  HANDLE_AND_OUTPUT(producer, uint64_t, splinecast_producer_consumed, "items", c_.producer,
                    number_);
  HANDLE_AND_OUTPUT(producer, uint64_t, splinecast_producer_stream_id, "id", c_.producer, number_);
}

}  // namespace splinecast::testing
