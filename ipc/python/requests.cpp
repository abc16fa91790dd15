#include <cstdint>
#include <string>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/held.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/times.hpp"
#include "ipc/python/waits.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/stopper.hpp"

namespace splinecast::python {
namespace {

/// The Python class RateCommander.
class HeldCommander {
 public:
  HeldCommander(const std::string& law, std::string name, const RegionAccess& access,
                const Trust& trusted)
      : name_(std::move(name)),
        commander_("rate commander", law, make_role<RateCommander>(law, name_, access, trusted)) {}

  std::uint64_t set_rate(double rate, py::handle ramp, py::handle wait) {
    const Time time = duration(ramp, "ramp");
    return request(wait, [&](RateCommander& own) { return own.set_rate(rate, time); });
  }
  std::uint64_t hold(py::handle ramp, py::handle wait) {
    const Time time = duration(ramp, "ramp");
    return request(wait, [&](RateCommander& own) { return own.hold(time); });
  }
  std::uint64_t release(py::handle ramp, py::handle wait) {
    const Time time = duration(ramp, "ramp");
    return request(wait, [&](RateCommander& own) { return own.release(time); });
  }
  void set_dead_man(py::handle timeout, py::handle ramp) {
    const Time time = duration(timeout, "timeout");
    const Time length = duration(ramp, "ramp");
    commander_.use([&](RateCommander& own) { own.set_dead_man(time, length); });
  }
  bool renew() {
    bool is_renewed = false;
    commander_.use([&](RateCommander& own) { is_renewed = own.renew(); });
    return is_renewed;
  }

  void close() { commander_.close(); }
  void exit(const py::args& /*failure*/) { close(); }
  [[nodiscard]] bool is_closed() const { return commander_.is_closed(); }
  [[nodiscard]] const std::string& law() const { return commander_.stream(); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string text() const {
    return "<splinecast.RateCommander '" + name_ + "' of '" + law() +
           (is_closed() ? "', closed>" : "'>");
  }

 private:
  template <typename Make>
  std::uint64_t request(py::handle wait, const Make& make) {
    return in_force(commander_, wait, name_, make);
  }

  std::string name_;
  Held<RateCommander> commander_;
};

std::unique_ptr<HeldCommander> make(const std::string& law, const std::string& commander,
                                    const py::kwargs& keywords) {
  require_keywords(keywords, "RateCommander", access_keywords());
  Trust trusted;
  const RegionAccess allowed = access(keywords, trusted);
  return std::make_unique<HeldCommander>(law, commander, allowed, trusted);
}

/// The Python class Stopper.
class HeldStopper {
 public:
  HeldStopper(const std::string& stream, std::string name, const RegionAccess& access,
              const Trust& trusted)
      : name_(std::move(name)),
        stopper_("stopper", stream, make_role<Stopper>(stream, name_, access, trusted)) {}

  std::uint64_t stop(py::handle wait) {
    return in_force(stopper_, wait, name_, [](Stopper& own) { return own.stop(); });
  }
  std::uint64_t release(py::handle wait) {
    return in_force(stopper_, wait, name_, [](Stopper& own) { return own.release(); });
  }
  bool is_latched() {
    return stopper_.use([](Stopper& own) { return own.is_latched(); });
  }

  void close() { stopper_.close(); }
  void exit(const py::args& /*failure*/) { close(); }
  [[nodiscard]] bool is_closed() const { return stopper_.is_closed(); }
  [[nodiscard]] const std::string& stream() const { return stopper_.stream(); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string text() const {
    return "<splinecast.Stopper '" + name_ + "' of '" + stream() +
           (is_closed() ? "', closed>" : "'>");
  }

 private:
  std::string name_;
  Held<Stopper> stopper_;
};

std::unique_ptr<HeldStopper> make_stopper(const std::string& stream, const std::string& stopper,
                                          const py::kwargs& keywords) {
  require_keywords(keywords, "Stopper", access_keywords());
  Trust trusted;
  const RegionAccess allowed = access(keywords, trusted);
  return std::make_unique<HeldStopper>(stream, stopper, allowed, trusted);
}

}  // namespace

void define_rate_commander(py::module_& module) {
  py::class_<HeldCommander>(module, "RateCommander", doc::RateCommander)
      .def(py::init(&make), py::arg("law"), py::arg("commander"), doc::RateCommander_init)
      .def("set_rate", &HeldCommander::set_rate, py::arg("rate"), py::arg("ramp"), py::kw_only(),
           py::arg("wait") = py::none(), doc::RateCommander_set_rate)
      .def("hold", &HeldCommander::hold, py::arg("ramp"), py::kw_only(),
           py::arg("wait") = py::none(), doc::RateCommander_hold)
      .def("release", &HeldCommander::release, py::arg("ramp"), py::kw_only(),
           py::arg("wait") = py::none(), doc::RateCommander_release)
      .def("set_dead_man", &HeldCommander::set_dead_man, py::arg("timeout"), py::arg("ramp") = 0.5,
           doc::RateCommander_set_dead_man)
      .def("renew", &HeldCommander::renew, doc::RateCommander_renew)
      .def("close", &HeldCommander::close, doc::RateCommander_close)
      .def(
          "__enter__", [](py::object self) { return self; }, doc::RateCommander_enter)
      .def("__exit__", &HeldCommander::exit, doc::RateCommander_exit)
      .def("__repr__", &HeldCommander::text)
      .def_property_readonly("law", &HeldCommander::law, doc::RateCommander_law)
      .def_property_readonly("commander", &HeldCommander::name, doc::RateCommander_commander)
      .def_property_readonly("is_closed", &HeldCommander::is_closed, doc::RateCommander_is_closed);
}

void define_stopper(py::module_& module) {
  py::class_<HeldStopper>(module, "Stopper", doc::Stopper)
      .def(py::init(&make_stopper), py::arg("stream"), py::arg("stopper"), doc::Stopper_init)
      .def("stop", &HeldStopper::stop, py::kw_only(), py::arg("wait") = py::none(),
           doc::Stopper_stop)
      .def("release", &HeldStopper::release, py::kw_only(), py::arg("wait") = py::none(),
           doc::Stopper_release)
      .def("close", &HeldStopper::close, doc::Stopper_close)
      .def(
          "__enter__", [](py::object self) { return self; }, doc::Stopper_enter)
      .def("__exit__", &HeldStopper::exit, doc::Stopper_exit)
      .def("__repr__", &HeldStopper::text)
      .def_property_readonly("is_latched", &HeldStopper::is_latched, doc::Stopper_is_latched)
      .def_property_readonly("stream", &HeldStopper::stream, doc::Stopper_stream)
      .def_property_readonly("stopper", &HeldStopper::name, doc::Stopper_stopper)
      .def_property_readonly("is_closed", &HeldStopper::is_closed, doc::Stopper_is_closed);
}

}  // namespace splinecast::python
