#include "splinecast/rate_commander.hpp"

#include <cstdint>
#include <string>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/held.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/options.hpp"
#include "ipc/python/values/times.hpp"
#include "ipc/python/waits.hpp"

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
  /// Makes a request; with `wait`, returns when it is in force, or raises TimeoutError.
  template <typename Make>
  std::uint64_t request(py::handle wait, const Make& make) {
    const auto timeout = optional_duration(wait, "wait");
    const std::uint64_t number = commander_.use(make);
    if (!timeout) return number;
    const bool is_in_force = wait_until(
        commander_, end_of(timeout),
        [number](RateCommander& own, Time time) { return own.wait_in_force(number, time); });
    if (is_in_force) return number;
    const std::string text = "request " + std::to_string(number) + " of '" + name_ + "' to '" +
                             law() + "' is not in force after " +
                             std::to_string(to_seconds(*timeout)) + " s; it remains";
    PyErr_SetString(PyExc_TimeoutError, text.c_str());
    throw py::error_already_set();
  }

  std::string name_;
  Held<RateCommander> commander_;
};

std::unique_ptr<HeldCommander> make(const std::string& law, const std::string& commander,
                                    const py::kwargs& keywords) {
  require_keywords(keywords, "RateCommander", {"mode", "group", "owner"});
  Trust trusted;
  const RegionAccess allowed = access(keywords, trusted);
  return std::make_unique<HeldCommander>(law, commander, allowed, trusted);
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

}  // namespace splinecast::python
