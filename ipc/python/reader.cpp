#include "splinecast/reader.hpp"

#include <pybind11/stl.h>

#include <algorithm>

#include "ipc/layout/header.hpp"
#include "ipc/python/docstrings.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/samples.hpp"
#include "ipc/python/segments.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/records.hpp"
#include "ipc/python/values/times.hpp"
#include "ipc/python/values/types.hpp"
#include "ipc/python/waits.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

/// From this number of times on, sample_many releases the GIL.
constexpr std::size_t kManyTimes = 64;

/// Waits for the stream in slices, so that a signal ends the wait.
std::unique_ptr<Reader> open(const std::string& stream, Time end, const Trust& trusted) {
  const MonotonicClock clock;
  for (;;) {
    const Time left = std::max(end - clock.now(), Time::zero());
    try {
      return make_role<Reader>(stream, std::min(left, kSignalSlice), trusted);
    } catch (const LawLost&) {
      throw;
    } catch (const NoSuchStream&) {
      check_signals();
      if (clock.now() >= end) throw;
    }
  }
}

const char* text_of(StreamClock clock) {
  switch (clock) {
    case StreamClock::recorded:
      return "recorded";
    case StreamClock::law:
      return "law";
    default:
      return "monotonic";
  }
}

/// Whether a time is before or after the curve.
bool is_beside_curve(SampleStatus status) noexcept {
  return status == SampleStatus::holding || status == SampleStatus::before_history ||
         status == SampleStatus::no_data;
}

/// The Python class Reader.
class HeldReader {
 public:
  HeldReader(const std::string& stream, py::handle timeout, py::handle owner)
      : reader_("reader", stream,
                open(stream, end_of(optional_duration(timeout, "timeout")), trust(owner))),
        dimensions_(reader_.use([](const Reader& reader) { return reader.dimensions(); })),
        is_live_(reader_.use([](const Reader& reader) { return is_live(reader.clock()); })) {}

  template <SampleStatus (Reader::*Evaluate)(Time, const StateRef&) noexcept>
  py::object sample(py::handle t, const py::object& out) {
    const Time time = instant(t);
    py::object made = out.is_none() ? py::cast(std::make_unique<Sample>(dimensions_)) : out;
    auto& sample = made.cast<Sample&>();
    sample.status =
        reader_.use([&](Reader& reader) { return (reader.*Evaluate)(time, sample.state.ref()); });
    sample.time = time;
    require_time_of_clock(time, sample.status);
    return made;
  }

  py::object sample_many(py::handle times, const py::object& out, const std::string& set) {
    const Instants instants(times);
    instants.require_line();
    py::object made = out;
    if (out.is_none()) {
      made = py::cast(std::make_unique<Block>(instants.size(), derivatives(set), dimensions_));
    } else if (py::isinstance<py::array>(out) && py::cast<py::array>(out).ndim() > 0) {
      made = py::cast(std::make_unique<Block>(py::cast<py::array>(out), dimensions_));
    }
    auto& block = made.cast<Block&>();
    if (block.size() != instants.size()) {
      throw BadRequest("the block is for " + std::to_string(block.size()) + " times, not for " +
                       std::to_string(instants.size()));
    }
    const SampleBlock memory = block.memory();
    std::uint64_t revision = 0;
    const auto evaluate = [&](Reader& reader) {
      revision = reader.sample_many(instants.times(block.scratch), memory);
    };
    if (instants.size() < kManyTimes) {
      reader_.use(evaluate);
    } else {
      reader_.require_own_process();
      without_gil([&] { reader_.use_without_gil(evaluate); });
    }
    block.revision = revision;
    block.clear_invalid();
    if (is_live_ && std::ranges::any_of(memory.status, is_beside_curve)) {
      const auto all = instants.times(block.scratch);
      for (std::size_t i = 0; i < all.size(); ++i) require_time_of_clock(all[i], memory.status[i]);
    }
    return made;
  }

  py::object snapshot(py::handle start, py::handle end) {
    const Time from = instant(start);
    const Time to = instant(end);
    auto segments = std::make_unique<Segments>(dimensions_);
    reader_.require_own_process();
    without_gil([&] {
      segments->status = reader_.use_without_gil(
          [&](Reader& reader) { return reader.snapshot(from, to, segments->snapshot); });
    });
    return py::cast(std::move(segments));
  }

  bool wait(py::handle timeout) {
    auto status = WaitStatus::timed_out;
    wait_until(reader_, end_of(optional_duration(timeout, "timeout")),
               [&status](Reader& reader, Time time) {
                 status = reader.wait(time);
                 return status != WaitStatus::timed_out;
               });
    if (status != WaitStatus::retired) return status == WaitStatus::advanced;
    throw NoSuchStream("stream '" + stream() + "' was removed or created again: make a new Reader");
  }

  /// What a const function of Reader returns.
  template <auto Get>
  auto get() const {
    return reader_.use([](Reader& reader) { return (reader.*Get)(); });
  }

  py::object excess(const Sample& sample) {
    return to_record(reader_.use([&](Reader& reader) { return reader.excess(sample.state); }));
  }

  py::object alive() const {
    const Alive found = get<&Reader::alive>();
    return type("Alive")(found.producer, found.solver);
  }

  std::vector<std::string> kinds() const {
    const auto kinds = reader_.use(
        [](Reader& reader) { return ipc::dimensions_of(ipc::Internals::header(reader)); });
    std::vector<std::string> texts;
    texts.reserve(kinds.size());
    for (const Dimension& dimension : kinds) texts.push_back(to_string(dimension));
    return texts;
  }

  void close() { reader_.close(); }
  void exit(const py::args& /*failure*/) { close(); }
  [[nodiscard]] std::size_t dimensions() const { return dimensions_; }
  [[nodiscard]] bool is_closed() const { return reader_.is_closed(); }
  [[nodiscard]] const std::string& stream() const { return reader_.stream(); }
  [[nodiscard]] std::string text() const {
    return "<splinecast.Reader '" + stream() + "' of " + std::to_string(dimensions_) +
           (is_closed() ? " dimensions, closed>" : " dimensions>");
  }

 private:
  /// A time far from the curve is one of another clock.
  void require_time_of_clock(Time time, SampleStatus status) const {
    if (is_beside_curve(status) && is_live_) require_near_now(time);
  }

  Held<Reader> reader_;
  std::size_t dimensions_;
  bool is_live_;
};

using Class = py::class_<HeldReader>;

void define_sampling(Class& reader) {
  const py::arg_v out = py::arg("out") = py::none();
  reader.def("sample", &HeldReader::sample<&Reader::sample>, py::arg("t"), out, doc::Reader_sample)
      .def("preview", &HeldReader::sample<&Reader::preview>, py::arg("t"), out, doc::Reader_preview)
      .def("sample_many", &HeldReader::sample_many, py::arg("times"), out,
           py::arg("derivatives") = "pvaj", doc::Reader_sample_many)
      .def("snapshot", &HeldReader::snapshot, py::arg("start"), py::arg("end"),
           doc::Reader_snapshot)
      .def("wait", &HeldReader::wait, py::arg("timeout") = py::none(), doc::Reader_wait)
      .def("excess", &HeldReader::excess, py::arg("state"), doc::Reader_excess)
      .def(
          "progress",
          [](const HeldReader& self) { return to_record(self.get<&Reader::progress>()); },
          doc::Reader_progress)
      .def("alive", &HeldReader::alive, doc::Reader_alive)
      .def(
          "rate", [](const HeldReader& self) { return to_record(self.get<&Reader::rate>()); },
          doc::Reader_rate)
      .def("close", &HeldReader::close, doc::Reader_close)
      .def(
          "__enter__", [](py::object self) { return self; }, doc::Reader_enter)
      .def("__exit__", &HeldReader::exit, doc::Reader_exit)
      .def("__repr__", &HeldReader::text);
}

void define_properties(Class& reader) {
  reader.def_property_readonly("stream", &HeldReader::stream, doc::Reader_stream)
      .def_property_readonly("dimensions", &HeldReader::dimensions, doc::Reader_dimensions)
      .def_property_readonly("names", &HeldReader::get<&Reader::names>, doc::Reader_names)
      .def_property_readonly("units", &HeldReader::get<&Reader::units>, doc::Reader_units)
      .def_property_readonly("kinds", &HeldReader::kinds, doc::Reader_kinds)
      .def_property_readonly(
          "clock", [](const HeldReader& self) { return text_of(self.get<&Reader::clock>()); },
          doc::Reader_clock)
      .def_property_readonly(
          "limits", [](const HeldReader& self) { return to_record(self.get<&Reader::limits>()); },
          doc::Reader_limits)
      .def_property_readonly(
          "settled_until",
          [](const HeldReader& self) { return optional_ns(self.get<&Reader::settled_until>()); },
          doc::Reader_settled_until)
      .def_property_readonly(
          "first_time",
          [](const HeldReader& self) {
            return optional_ns(self.get<&Reader::first_time>().value_or(Time::min()));
          },
          doc::Reader_first_time)
      .def_property_readonly("is_closed", &HeldReader::is_closed, doc::Reader_is_closed)
      .def_property_readonly("is_memory_locked", &HeldReader::get<&Reader::is_memory_locked>,
                             doc::Reader_is_memory_locked);
}

}  // namespace

void define_reader(py::module_& module) {
  Class reader(module, "Reader", doc::Reader);
  reader.def(py::init<const std::string&, py::handle, py::handle>(), py::arg("stream"),
             py::arg("timeout") = 0.0, py::arg("owner") = py::none(), doc::Reader_init);
  define_sampling(reader);
  define_properties(reader);
}

}  // namespace splinecast::python
