#include "splinecast/producer.hpp"

#include <pybind11/stl.h>

#include <chrono>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/records.hpp"
#include "ipc/python/values/types.hpp"
#include "ipc/python/values/waypoints.hpp"
#include "ipc/python/waits.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

/// Seconds that __exit__ waits for room in a full ring.
constexpr double kFinishPatience = 1;
/// Waypoints that append_many appends before other threads have their turn.
constexpr std::size_t kBatch = 256;

using None = py::none;

/// The length of a transition in seconds. A longer one than a minute is one in milliseconds.
ReplaceOptions blend_of(py::handle value) {
  constexpr Time kLongest = std::chrono::minutes(1);
  const Time blend = duration(value, "blend");
  if (blend <= kLongest) return {.blend = blend};
  throw BadRequest("blend is in seconds, at most 60, not " + std::string(py::repr(value)) +
                   ": 80 ms are 0.08");
}

/// The Python class Producer.
class HeldProducer {
 public:
  HeldProducer(const std::string& stream, const ProducerOptions& options)
      : dimensions_(options.dimensions),
        clock_(options.clock),
        names_(options.names),
        producer_("producer", stream, make_role<Producer>(stream, options)) {}

  std::uint64_t append(py::handle t, py::handle x, py::handle velocity, py::handle acceleration,
                       py::handle timeout) {
    const Time time = instant(t);
    const Row position(x, "position");
    const Row given_velocity(velocity, "velocity");
    const Row given_acceleration(acceleration, "acceleration");
    const Waypoint waypoint{.time = time,
                            .position = position.values(),
                            .velocity = given_velocity.values(),
                            .acceleration = given_acceleration.values()};
    return accept(asked("waypoint", waypoint), timeout,
                  [&](Producer& producer) { return producer.append(waypoint); });
  }

  std::uint64_t append_many(py::handle times, py::handle positions, py::handle velocities,
                            py::handle accelerations, py::handle timeout);

  std::uint64_t replace_from(py::handle t, py::handle times, py::handle positions,
                             py::handle velocities, py::handle accelerations, py::handle blend) {
    const Time time = instant_or_soonest(t);
    const Path path(dimensions_, times, positions, velocities, accelerations);
    const ReplaceOptions options = blend_of(blend);
    Asked asked{{.what = "replacement", .status = {}}, {}, {}};
    if (!t.is_none()) asked.item.time = asked.latest = time;
    if (!path.waypoints.empty()) {
      asked.first = path.waypoints.front();
      asked.latest = path.waypoints.back().time;
    }
    return accept(asked, py::int_(0), [&](Producer& producer) {
      return producer.replace_from(time, path.waypoints, options);
    });
  }

  py::object preview_replace(py::handle t, py::handle times, py::handle positions,
                             py::handle velocities, py::handle accelerations, py::handle blend) {
    const Time time = instant_or_soonest(t);
    const Path path(dimensions_, times, positions, velocities, accelerations);
    const ReplaceOptions options = blend_of(blend);
    ReplacePreview preview;
    producer_.require_own_process();
    without_gil([&] {
      producer_.use_without_gil([&](Producer& producer) {
        producer.preview_replace(time, path.waypoints, options, preview);
      });
    });
    return to_record(preview);
  }

  std::uint64_t start_from(py::handle t, py::handle position, py::handle velocity,
                           py::handle acceleration, bool moved) {
    const Row x(position, "position");
    const Row v(velocity, "velocity");
    const Row a(acceleration, "acceleration");
    const std::vector<double> rest(dimensions_);
    const bool is_whole = !moved || !v.values().empty() || !a.values().empty();
    const auto values = [&](const Row& row) {
      return row.values().empty() && is_whole ? std::span<const double>(rest) : row.values();
    };
    const Instant state{.time = instant(t),
                        .position = x.values(),
                        .velocity = values(v),
                        .acceleration = values(a)};
    return accept(asked("start state", {.time = state.time, .position = state.position}),
                  py::int_(0),
                  [&](Producer& producer) { return producer.start_from(state, {.moved = moved}); });
  }

  std::vector<std::string> stopped_by() {
    return producer_.use([](Producer& producer) { return producer.stopped_by(); });
  }
  py::object old_end() {
    return producer_.use([](Producer& producer) -> py::object {
      const Instant end = producer.old_end();
      if (end.position.empty()) return py::none();
      return py::make_tuple(
          end.time.count(),
          py::array_t<double>(static_cast<py::ssize_t>(end.position.size()), end.position.data()));
    });
  }

  std::uint64_t finish(py::handle end, py::handle timeout) {
    const Condition how = condition(end);
    const std::uint64_t item =
        accept({{.what = "end of the stream", .status = {}}, std::nullopt, {}}, timeout,
               [&](Producer& producer) { return producer.finish(how); });
    is_finished_ = true;
    return item;
  }

  py::object refusals() {
    Refusals found;
    producer_.use([&](Producer& producer) { producer.refusals(found); });
    return to_record(found, names_);
  }

  py::object outcome(std::uint64_t item) {
    return to_record(producer_.use([&](Producer& producer) { return producer.outcome(item); }));
  }

  py::object wait_outcome(std::uint64_t item, py::handle timeout) {
    ItemOutcome found;
    (void)wait_until(producer_, end_of(optional_duration(timeout, "timeout")),
                     [&](Producer& producer, Time time) {
                       return is_known(found = producer.wait_outcome(item, time));
                     });
    return to_record(found);
  }

  /// One of the waits of Producer.
  template <bool (Producer::*Wait)(Time)>
  bool wait(py::handle timeout) {
    return wait_until(producer_, end_of(optional_duration(timeout, "timeout")),
                      [](Producer& producer, Time time) { return (producer.*Wait)(time); });
  }

  /// What a const function of Producer returns.
  template <auto Get>
  auto get() const {
    return producer_.use([](Producer& producer) { return (producer.*Get)(); });
  }

  void withdraw() {
    producer_.use([](Producer& producer) { producer.withdraw(); });
    close();
  }

  void close() { producer_.close(); }

  void exit(const py::args& failure) {
    const bool has_failed = !failure[0].is_none();
    if (is_finished_ || producer_.is_closed() || (has_failed && !is_live(clock_))) return close();
    try {
      if (has_failed) stop_at_once();
      finish(py::str("halt"), py::float_(kFinishPatience));
    } catch (...) {
      close();
      if (!has_failed) throw;  // else the exception of the body is the one to be seen
    }
    close();
  }

  [[nodiscard]] std::size_t dimensions() const { return dimensions_; }
  [[nodiscard]] bool is_finished() const { return is_finished_; }
  [[nodiscard]] bool is_closed() const { return producer_.is_closed(); }
  [[nodiscard]] const std::string& stream() const { return producer_.stream(); }
  [[nodiscard]] std::string text() const {
    const std::string life = is_closed() ? ", closed" : is_finished_ ? ", finished" : "";
    return "<splinecast.Producer '" + stream() + "' of " + std::to_string(dimensions_) +
           " dimensions" + life + '>';
  }

 private:
  void stop_at_once() {
    accept({{.what = "stop", .status = {}}, std::nullopt, {}}, py::float_(kFinishPatience),
           [](Producer& producer) { return producer.replace_from({}); });
  }

  /// A call, as a message describes it.
  struct Asked {
    NotAccepted item;
    std::optional<Time> latest;  ///< its time, or that of its last waypoint
    Waypoint first;              ///< the waypoint that may start the stream, if its position is set
  };
  [[nodiscard]] static Asked asked(const char* what, const Waypoint& waypoint) {
    return {{.what = what, .status = {}, .time = waypoint.time, .position = waypoint.position},
            waypoint.time,
            waypoint};
  }

  /// Appends an item, which may wait for room. Returns its number; raises Refused.
  template <typename Append>
  std::uint64_t accept(const Asked& asked, py::handle timeout, const Append& append) {
    std::uint64_t number = 0;
    NotAccepted item = asked.item;
    const auto try_once = [&](Producer& producer) {
      const AppendStatus status = append(producer);
      if (status == AppendStatus::accepted) number = producer.last_item();
      return status;
    };
    item.status = producer_.use(try_once);
    if (item.status == AppendStatus::full) {
      const Time end = end_of(optional_duration(timeout, "timeout"));
      while (item.status == AppendStatus::full && wait_for_room(end)) {
        item.status = producer_.use(try_once);
      }
    }
    if (item.status != AppendStatus::accepted) refuse(asked, item.status);
    return number;
  }

  [[noreturn]] void refuse(const Asked& asked, AppendStatus status) {
    NotAccepted item = asked.item;
    item.status = status;
    const bool is_about_now = status == AppendStatus::past || status == AppendStatus::too_far_ahead;
    if (is_about_now && clock_ == StreamClock::monotonic && asked.latest) {
      item.reason = compared_with_now(*asked.latest);
    } else if (status == AppendStatus::too_late) {
      const Time earliest = producer_.use([](Producer& producer) { return producer.earliest(); });
      item.reason = "the earliest is now " + std::to_string(earliest.count()) + " ns";
    } else if (status == AppendStatus::elsewhere) {
      item.reason =
          producer_.use([&](Producer& producer) { return producer.why_elsewhere(asked.first); });
    } else if (status == AppendStatus::stopped) {
      item.reason = py::cast<std::string>(py::str(", ").attr("join")(stopped_by()));
    }
    throw_refused(item);
  }

  /// Returns false if `end` is over, or passes.
  bool wait_for_room(Time end) {
    if (MonotonicClock().now() >= end) return false;
    return wait_until(producer_, end,
                      [](Producer& producer, Time time) { return producer.wait_for_room(time); });
  }

  std::size_t dimensions_;
  StreamClock clock_;
  std::vector<std::string> names_;
  bool is_finished_ = false;
  Held<Producer> producer_;
};

std::uint64_t HeldProducer::append_many(py::handle times, py::handle positions,
                                        py::handle velocities, py::handle accelerations,
                                        py::handle timeout) {
  GivenWaypoints waypoints(times, positions, velocities, accelerations, dimensions_);
  const Time end = end_of(optional_duration(timeout, "timeout"));
  std::size_t i = 0;
  AppendStatus status = AppendStatus::accepted;
  std::uint64_t first = producer_.use([](Producer& producer) { return producer.appended(); });
  const auto append_batch = [&](Producer& producer) {
    status = AppendStatus::accepted;
    for (std::size_t n = 0; n < kBatch && i < waypoints.size(); ++n, ++i) {
      status = producer.append(waypoints[i]);
      if (status != AppendStatus::accepted) return;
      if (i == 0) first = producer.last_item();
    }
  };
  while (i < waypoints.size()) {
    without_gil([&] { producer_.use_without_gil(append_batch); });
    if (status == AppendStatus::accepted) {
      check_signals();
    } else if (status != AppendStatus::full || !wait_for_room(end)) {
      Asked item = asked("waypoint", waypoints[i]);
      item.item.index = i;
      refuse(item, status);
    }
  }
  return first;
}

using Class = py::class_<HeldProducer>;

void define_appends(Class& producer) {
  const py::arg_v velocity = py::arg("velocity") = None();
  const py::arg_v acceleration = py::arg("acceleration") = None();
  const py::arg_v timeout = py::arg("timeout") = 0.0;
  producer
      .def("append", &HeldProducer::append, py::arg("t"), py::arg("x"), velocity, acceleration,
           timeout, doc::Producer_append)
      .def("append_many", &HeldProducer::append_many, py::arg("times"), py::arg("positions"),
           py::arg("velocities") = None(), py::arg("accelerations") = None(), timeout,
           doc::Producer_append_many)
      .def("replace_from", &HeldProducer::replace_from, py::arg("t") = None(),
           py::arg("times") = None(), py::arg("positions") = None(), py::arg("velocities") = None(),
           py::arg("accelerations") = None(), py::arg("blend") = 0.0, doc::Producer_replace_from)
      .def("preview_replace", &HeldProducer::preview_replace, py::arg("t") = None(),
           py::arg("times") = None(), py::arg("positions") = None(), py::arg("velocities") = None(),
           py::arg("accelerations") = None(), py::arg("blend") = 0.0, doc::Producer_preview_replace)
      .def("start_from", &HeldProducer::start_from, py::arg("t"), py::arg("position"),
           py::arg("velocity") = None(), py::arg("acceleration") = None(), py::arg("moved") = false,
           doc::Producer_start_from)
      .def("old_end", &HeldProducer::old_end, doc::Producer_old_end)
      .def("stopped_by", &HeldProducer::stopped_by, doc::Producer_stopped_by)
      .def("finish", &HeldProducer::finish, py::arg("end") = "halt", timeout, doc::Producer_finish);
}

void define_waits(Class& producer) {
  const py::arg_v timeout = py::arg("timeout") = None();
  producer.def("refusals", &HeldProducer::refusals, doc::Producer_refusals)
      .def(
          "now", [](HeldProducer& self) { return self.get<&Producer::now>().count(); },
          doc::Producer_now)
      .def("outcome", &HeldProducer::outcome, py::arg("item"), doc::Producer_outcome)
      .def("wait_outcome", &HeldProducer::wait_outcome, py::arg("item"), timeout,
           doc::Producer_wait_outcome)
      .def("wait_for_solver", &HeldProducer::wait<&Producer::wait_for_solver>, timeout,
           doc::Producer_wait_for_solver)
      .def("wait_for_room", &HeldProducer::wait<&Producer::wait_for_room>, timeout,
           doc::Producer_wait_for_room)
      .def("wait_until_consumed", &HeldProducer::wait<&Producer::wait_until_consumed>, timeout,
           doc::Producer_wait_until_consumed)
      .def("withdraw", &HeldProducer::withdraw, doc::Producer_withdraw)
      .def("close", &HeldProducer::close, doc::Producer_close)
      .def(
          "__enter__", [](py::object self) { return self; }, doc::Producer_enter)
      .def("__exit__", &HeldProducer::exit, doc::Producer_exit)
      .def("__repr__", &HeldProducer::text);
}

void define_properties(Class& producer) {
  producer.def_property_readonly("stream", &HeldProducer::stream, doc::Producer_stream)
      .def_property_readonly("dimensions", &HeldProducer::dimensions, doc::Producer_dimensions)
      .def_property_readonly(
          "earliest",
          [](HeldProducer& self) { return optional_ns(self.get<&Producer::earliest>()); },
          doc::Producer_earliest)
      .def_property_readonly(
          "replacement_begin",
          [](HeldProducer& self) { return to_record(self.get<&Producer::replacement_begin>()); },
          doc::Producer_replacement_begin)
      .def_property_readonly(
          "last_time", [](HeldProducer& self) { return self.get<&Producer::last_time>().count(); },
          doc::Producer_last_time)
      .def_property_readonly("last_item", &HeldProducer::get<&Producer::last_item>,
                             doc::Producer_last_item)
      .def_property_readonly("appended", &HeldProducer::get<&Producer::appended>,
                             doc::Producer_appended)
      .def_property_readonly("consumed", &HeldProducer::get<&Producer::consumed>,
                             doc::Producer_consumed)
      .def_property_readonly("continues", &HeldProducer::get<&Producer::continues>,
                             doc::Producer_continues)
      .def_property_readonly("solver_alive", &HeldProducer::get<&Producer::solver_alive>,
                             doc::Producer_solver_alive)
      .def_property_readonly("is_finished", &HeldProducer::is_finished, doc::Producer_is_finished)
      .def_property_readonly("is_closed", &HeldProducer::is_closed, doc::Producer_is_closed)
      .def_property_readonly("is_memory_locked", &HeldProducer::get<&Producer::is_memory_locked>,
                             doc::Producer_is_memory_locked)
      .def_property_readonly("stream_id", &HeldProducer::get<&Producer::stream_id>,
                             doc::Producer_stream_id);
}

/// The keywords of the constructor; those that have no value keep the default of ProducerOptions.
std::unique_ptr<HeldProducer> make(const std::string& stream, const py::object& names,
                                   const py::object& units, const py::kwargs& keywords) {
  keywords["names"] = names;
  keywords["units"] = units;
  require_keywords(keywords, "Producer", producer_keywords());
  return std::make_unique<HeldProducer>(stream, producer_options(keywords));
}

}  // namespace

void define_producer(py::module_& module) {
  Class producer(module, "Producer", doc::Producer);
  producer.def(py::init(&make), py::arg("stream"), py::arg("names") = None(),
               py::arg("units") = None(), doc::Producer_init);
  define_appends(producer);
  define_waits(producer);
  define_properties(producer);
}

}  // namespace splinecast::python
