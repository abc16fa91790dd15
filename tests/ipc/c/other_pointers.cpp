#include "tests/ipc/c/every_pointer.hpp"

/// The pointers of solvers, readers, snapshots and curves.
namespace splinecast::testing {

void CPointers::add_solver() {
  const char* create = "splinecast_solver_create";
  wrong_.text(create, "stream", [](auto* p) {
    splinecast_solver* out = nullptr;
    return splinecast_solver_create(p, nullptr, &out);
  });
  wrong_.pointer<const splinecast_solver_options>(
      create, "options",
      [](auto* p) {
        splinecast_solver* out = nullptr;
        return splinecast_solver_create("c.pointers", p, &out);
      },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_solver*>(
      create, "out", [](auto* p) { return splinecast_solver_create("c.pointers", nullptr, p); });
  wrong_.handle<splinecast_solver>(
      "splinecast_solver_destroy", "solver", [](auto* p) { return splinecast_solver_destroy(p); },
      c_.reader, WrongPointers::Null::allowed);
  solver("splinecast_solver_step", [](auto* p) { return splinecast_solver_step(p, nullptr); });
  wrong_.pointer<splinecast_step_result>(
      "splinecast_solver_step", "out",
      [this](auto* p) { return splinecast_solver_step(c_.solver, p); },
      WrongPointers::Null::allowed);
  HANDLE_ONLY(solver, splinecast_solver_attach);
  HANDLE_ONLY(solver, splinecast_solver_wait, , 0);
  HANDLE_ONLY(solver, splinecast_solver_attached);
  HANDLE_ONLY(solver, splinecast_solver_took_over);
  HANDLE_ONLY(solver, splinecast_solver_is_memory_locked);
  HANDLE_AND_OUTPUT(solver, std::int64_t, splinecast_solver_due, "time", c_.solver, time_);
  HANDLE_AND_OUTPUT(solver, splinecast_limit_excess, splinecast_solver_first_excess, "out",
                    c_.solver, excess_);
  solver("splinecast_solver_first_refusals", [](auto* p) {
    splinecast_refusals out = SPLINECAST_REFUSALS_INIT;
    return splinecast_solver_first_refusals(p, &out);
  });
  wrong_.pointer<splinecast_refusals>("splinecast_solver_first_refusals", "out", [this](auto* p) {
    return splinecast_solver_first_refusals(c_.solver, p);
  });
}

void CPointers::add_reader() {
  const char* create = "splinecast_reader_create";
  wrong_.text(create, "stream", [](auto* p) {
    splinecast_reader* out = nullptr;
    return splinecast_reader_create(p, 0, nullptr, &out);
  });
  wrong_.pointer<const splinecast_reader_options>(
      create, "options",
      [this](auto* p) {
        splinecast_reader* out = nullptr;
        return splinecast_reader_create(c_.name(), 0, p, &out);
      },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_reader*>(create, "out", [this](auto* p) {
    return splinecast_reader_create(c_.name(), 0, nullptr, p);
  });
  wrong_.handle<splinecast_reader>(
      "splinecast_reader_destroy", "reader", [](auto* p) { return splinecast_reader_destroy(p); },
      c_.producer, WrongPointers::Null::allowed);
  for (const auto& [name, function] :
       {std::pair("splinecast_reader_sample", &splinecast_reader_sample),
        std::pair("splinecast_reader_preview", &splinecast_reader_preview)}) {
    reader(name, [this, call = function](auto* p) { return call(p, 0, &state_.state); });
    wrong_.pointer<const splinecast_state>(
        name, "out", [this, call = function](auto* p) { return call(c_.reader, 0, p); });
  }
  HANDLE_ONLY(reader, splinecast_reader_dimensions);
  HANDLE_ONLY(reader, splinecast_reader_alive);
  HANDLE_ONLY(reader, splinecast_reader_clock);
  HANDLE_ONLY(reader, splinecast_reader_is_memory_locked);
  HANDLE_ONLY(reader, splinecast_reader_wait, , 0);
  reader("splinecast_reader_name", [](auto* p) { return of_text(splinecast_reader_name(p, 0)); });
  reader("splinecast_reader_unit", [](auto* p) { return of_text(splinecast_reader_unit(p, 0)); });
  reader("splinecast_reader_kind_text",
         [](auto* p) { return of_text(splinecast_reader_kind_text(p, 0)); });
}

void CPointers::add_reader_outputs() {
  HANDLE_AND_OUTPUT(reader, std::int64_t, splinecast_reader_settled_until, "time", c_.reader,
                    time_);
  HANDLE_AND_OUTPUT(reader, splinecast_law_rate, splinecast_reader_rate, "out", c_.reader, rate_);
  HANDLE_AND_OUTPUT(reader, std::int64_t, splinecast_reader_first_time, "time", c_.reader, time_);
  wrong_.pointer<splinecast_limits>("splinecast_reader_limits", "out", [this](auto* p) {
    return splinecast_reader_limits(c_.reader, p);
  });
  reader("splinecast_reader_limits", [](auto* p) {
    splinecast_limits out = SPLINECAST_LIMITS_INIT;
    return splinecast_reader_limits(p, &out);
  });
  wrong_.pointer<splinecast_progress>("splinecast_reader_progress", "out", [this](auto* p) {
    return splinecast_reader_progress(c_.reader, p);
  });
  reader("splinecast_reader_progress", [](auto* p) {
    splinecast_progress out = SPLINECAST_PROGRESS_INIT;
    return splinecast_reader_progress(p, &out);
  });
  const char* excess = "splinecast_reader_excess";
  reader(excess, [this](auto* p) { return splinecast_reader_excess(p, &state_.state, &place_); });
  wrong_.pointer<const splinecast_state>(excess, "sampled", [this](auto* p) {
    return splinecast_reader_excess(c_.reader, p, &place_);
  });
  wrong_.pointer<splinecast_excess>(excess, "out", [this](auto* p) {
    return splinecast_reader_excess(c_.reader, &state_.state, p);
  });
  reader("splinecast_reader_kind", [](auto* p) {
    splinecast_dimension out = {};
    return splinecast_reader_kind(p, 0, &out);
  });
  wrong_.pointer<splinecast_dimension>("splinecast_reader_kind", "out", [this](auto* p) {
    return splinecast_reader_kind(c_.reader, 0, p);
  });
}

void CPointers::add_many_samples() {
  const char* many = "splinecast_reader_sample_many";
  const auto call = [this](splinecast_reader* own, const splinecast_times* times,
                           const splinecast_output_matrix* values, uint8_t* statuses,
                           uint64_t* revision) {
    return splinecast_reader_sample_many(own, times, 15, values, statuses, 1, revision);
  };
  uint8_t* const ok = statuses_.data();
  reader(many, [=, this](auto* p) { return call(p, &at_, &matrix_, ok, nullptr); });
  wrong_.pointer<const splinecast_times>(
      many, "times", [=, this](auto* p) { return call(c_.reader, p, &matrix_, ok, nullptr); });
  wrong_.pointer<const splinecast_output_matrix>(
      many, "values", [=, this](auto* p) { return call(c_.reader, &at_, p, ok, nullptr); });
  wrong_.pointer<uint8_t>(
      many, "statuses", [=, this](auto* p) { return call(c_.reader, &at_, &matrix_, p, nullptr); });
  wrong_.pointer<uint64_t>(
      many, "revision", [=, this](auto* p) { return call(c_.reader, &at_, &matrix_, ok, p); },
      WrongPointers::Null::allowed);
}

void CPointers::add_snapshot() {
  const auto snapshot = [this](const char* function, const auto& call) {
    wrong_.handle<splinecast_snapshot>(function, "snapshot", call, c_.producer);
  };
  wrong_.pointer<splinecast_snapshot*>("splinecast_snapshot_create", "out",
                                       [](auto* p) { return splinecast_snapshot_create(2, p); });
  wrong_.handle<splinecast_snapshot>(
      "splinecast_snapshot_destroy", "snapshot",
      [](auto* p) { return splinecast_snapshot_destroy(p); }, c_.producer,
      WrongPointers::Null::allowed);
  reader("splinecast_reader_snapshot",
         [this](auto* p) { return splinecast_reader_snapshot(p, 0, 1, snapshot_); });
  wrong_.handle<splinecast_snapshot>(
      "splinecast_reader_snapshot", "out",
      [this](auto* p) { return splinecast_reader_snapshot(c_.reader, 0, 1, p); }, c_.producer);
  HANDLE_AND_OUTPUT(snapshot, size_t, splinecast_snapshot_segments, "segments", snapshot_, size_);
  HANDLE_AND_OUTPUT(snapshot, uint64_t, splinecast_snapshot_revision, "revision", snapshot_,
                    number_);
  HANDLE_AND_OUTPUT(snapshot, std::int64_t, splinecast_snapshot_settled_until, "time", snapshot_,
                    time_);
  snapshot("splinecast_snapshot_segment",
           [this](auto* p) { return splinecast_snapshot_segment(p, 0, &segment_); });
  wrong_.pointer<splinecast_segment>("splinecast_snapshot_segment", "out", [this](auto* p) {
    return splinecast_snapshot_segment(snapshot_, 0, p);
  });
}

void CPointers::add_curve() {
  const auto curve = [this](const char* function, const auto& call) {
    wrong_.handle<splinecast_curve>(function, "curve", call, c_.producer);
  };
  wrong_.handle<splinecast_curve>(
      "splinecast_curve_destroy", "curve", [](auto* p) { return splinecast_curve_destroy(p); },
      c_.producer, WrongPointers::Null::allowed);
  HANDLE_ONLY(curve, splinecast_curve_dimensions);
  HANDLE_AND_OUTPUT(curve, size_t, splinecast_curve_segments, "segments", curve_, size_);
  curve("splinecast_curve_segment",
        [this](auto* p) { return splinecast_curve_segment(p, 0, &segment_); });
  wrong_.pointer<splinecast_segment>("splinecast_curve_segment", "out", [this](auto* p) {
    return splinecast_curve_segment(curve_, 0, p);
  });
  curve("splinecast_curve_evaluate",
        [this](auto* p) { return splinecast_curve_evaluate(p, 0, &state_.state); });
  wrong_.pointer<const splinecast_state>("splinecast_curve_evaluate", "out", [this](auto* p) {
    return splinecast_curve_evaluate(curve_, 0, p);
  });
  curve("splinecast_curve_derivative",
        [this](auto* p) { return splinecast_curve_derivative(p, 0, 0, &output_); });
  wrong_.pointer<const splinecast_output>("splinecast_curve_derivative", "out", [this](auto* p) {
    return splinecast_curve_derivative(curve_, 0, 0, p);
  });
}

void CPointers::add_fit() {
  wrong_.pointer<const splinecast_waypoints>("splinecast_fit", "waypoints", [](auto* p) {
    splinecast_curve* out = nullptr;
    return splinecast_fit(p, nullptr, &out);
  });
  wrong_.pointer<const splinecast_fit_options>(
      "splinecast_fit", "options",
      [this](auto* p) {
        splinecast_curve* out = nullptr;
        return splinecast_fit(&path_, p, &out);
      },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_curve*>("splinecast_fit", "out",
                                    [this](auto* p) { return splinecast_fit(&path_, nullptr, p); });
  wrong_.pointer<const splinecast_waypoints>(
      "splinecast_cross_validated_lambda", "waypoints",
      [this](auto* p) { return splinecast_cross_validated_lambda(p, values_.data()); });
  wrong_.pointer<double>("splinecast_cross_validated_lambda", "lambda",
                         [this](auto* p) { return splinecast_cross_validated_lambda(&path_, p); });
}

void CPointers::add_rate_commander() {
  const char* create = "splinecast_rate_commander_create";
  const char* law = law_.name().c_str();
  const auto make = [](const char* named, const char* name,
                       const splinecast_rate_commander_options* options) {
    splinecast_rate_commander* out = nullptr;
    return splinecast_rate_commander_create(named, name, options, &out);
  };
  wrong_.text(create, "law", [make](auto* p) { return make(p, "b", nullptr); });
  wrong_.text(create, "commander", [make, law](auto* p) { return make(law, p, nullptr); });
  wrong_.pointer<const splinecast_rate_commander_options>(
      create, "options", [make, law](auto* p) { return make(law, "b", p); },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_rate_commander*>(create, "out", [law](auto* p) {
    return splinecast_rate_commander_create(law, "b", nullptr, p);
  });
  wrong_.handle<splinecast_rate_commander>(
      "splinecast_rate_commander_destroy", "commander",
      [](auto* p) { return splinecast_rate_commander_destroy(p); }, c_.producer,
      WrongPointers::Null::allowed);
  const auto commander = [this](const char* function, const auto& call) {
    wrong_.handle<splinecast_rate_commander>(function, "commander", call, c_.producer);
  };
  HANDLE_ONLY(commander, splinecast_rate_commander_set_rate, , 1, 1'000'000);
  HANDLE_ONLY(commander, splinecast_rate_commander_hold, , 1'000'000);
  HANDLE_ONLY(commander, splinecast_rate_commander_release, , 1'000'000);
  HANDLE_ONLY(commander, splinecast_rate_commander_set_dead_man, , 0, 1'000'000);
  HANDLE_ONLY(commander, splinecast_rate_commander_renew);
  HANDLE_AND_OUTPUT(commander, uint64_t, splinecast_rate_commander_number, "number", commander_,
                    number_);
  HANDLE_ONLY(commander, splinecast_rate_commander_wait_in_force, , 1, 1);
}

void CPointers::add_stopper() {
  const char* create = "splinecast_stopper_create";
  const char* stream = law_.name().c_str();
  const auto make = [](const char* named, const char* name,
                       const splinecast_stopper_options* options) {
    splinecast_stopper* out = nullptr;
    return splinecast_stopper_create(named, name, options, &out);
  };
  wrong_.text(create, "stream", [make](auto* p) { return make(p, "b", nullptr); });
  wrong_.text(create, "stopper", [make, stream](auto* p) { return make(stream, p, nullptr); });
  wrong_.pointer<const splinecast_stopper_options>(
      create, "options", [make, stream](auto* p) { return make(stream, "b", p); },
      WrongPointers::Null::allowed);
  wrong_.pointer<splinecast_stopper*>(create, "out", [stream](auto* p) {
    return splinecast_stopper_create(stream, "b", nullptr, p);
  });
  wrong_.handle<splinecast_stopper>(
      "splinecast_stopper_destroy", "stopper",
      [](auto* p) { return splinecast_stopper_destroy(p); }, c_.producer,
      WrongPointers::Null::allowed);
  const auto stopper = [this](const char* function, const auto& call) {
    wrong_.handle<splinecast_stopper>(function, "stopper", call, c_.producer);
  };
  HANDLE_ONLY(stopper, splinecast_stopper_stop);
  HANDLE_ONLY(stopper, splinecast_stopper_release);
  HANDLE_ONLY(stopper, splinecast_stopper_is_latched);
  HANDLE_AND_OUTPUT(stopper, uint64_t, splinecast_stopper_number, "number", stopper_, number_);
  HANDLE_ONLY(stopper, splinecast_stopper_wait_in_force, , 1, 1);
}

}  // namespace splinecast::testing
