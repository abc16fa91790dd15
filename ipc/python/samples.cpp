#include "ipc/python/samples.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "ipc/python/docstrings.hpp"
#include "ipc/python/module.hpp"
#include "ipc/python/values/arrays.hpp"
#include "ipc/python/values/types.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::python {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kLetters = "pvaj";

std::string letters(Derivatives set) {
  std::string text;
  for (std::size_t r = 0; r < kLetters.size(); ++r) {
    if (contains(set, static_cast<Derivatives>(1U << r))) text += kLetters[r];
  }
  return text;
}

/// A view of a part of a state's memory, which keeps the state alive.
py::array view(py::handle self, std::span<const double> values) {
  return {
      py::dtype::of<double>(), {static_cast<py::ssize_t>(values.size())}, {}, values.data(), self};
}

template <VectorView (State::*Part)() const noexcept>
py::array part(py::handle self) {
  return view(self, (self.cast<const Sample&>().state.*Part)());
}

py::array all_parts(py::handle self) {
  const State& state = self.cast<const Sample&>().state;
  const auto dimensions = static_cast<py::ssize_t>(state.dimensions());
  return {py::dtype::of<double>(), {py::ssize_t{4}, dimensions}, {}, state.values().data(), self};
}

std::string text(py::handle self) {
  const auto& sample = self.cast<const Sample&>();
  return "<splinecast.State at " + std::to_string(sample.time.count()) + " ns, " +
         std::string(to_string(sample.status)) + ", position " +
         std::string(py::str(part<&State::position>(self))) + '>';
}

void define_state(py::module_& module) {
  py::class_<Sample>(module, "State", doc::State)
      .def(py::init([](std::size_t dimensions) {
             if (dimensions >= kMinDimensions && dimensions <= kMaxDimensions) {
               return std::make_unique<Sample>(dimensions);
             }
             throw BadRequest("dimensions must be 1 to 64, not " + std::to_string(dimensions));
           }),
           py::arg("dimensions"), doc::State_init)
      .def_property_readonly("position", &part<&State::position>, doc::State_position)
      .def_property_readonly("velocity", &part<&State::velocity>, doc::State_velocity)
      .def_property_readonly("acceleration", &part<&State::acceleration>, doc::State_acceleration)
      .def_property_readonly("jerk", &part<&State::jerk>, doc::State_jerk)
      .def_property_readonly("values", &all_parts, doc::State_values)
      .def_property_readonly(
          "status", [](const Sample& self) { return member(self.status); }, doc::State_status)
      .def_property_readonly(
          "time", [](const Sample& self) { return self.time.count(); }, doc::State_time)
      .def_property_readonly(
          "dimensions", [](const Sample& self) { return self.state.dimensions(); },
          doc::State_dimensions)
      .def("__repr__", &text);
}

void define_block(py::module_& module) {
  py::class_<Block>(module, "Block", doc::Block)
      .def_property_readonly(
          "values", [](const Block& self) { return self.values; }, doc::Block_values)
      .def_property_readonly(
          "status", [](const Block& self) { return self.status; }, doc::Block_status)
      .def_property_readonly(
          "revision", [](const Block& self) { return self.revision; }, doc::Block_revision)
      .def_property_readonly(
          "derivatives", [](const Block& self) { return letters(self.derivatives); },
          doc::Block_derivatives)
      .def_property_readonly(
          "shape", [](const Block& self) { return self.values.attr("shape"); }, doc::Block_shape)
      .def("__len__", &Block::size, doc::Block_len)
      .def(
          "__getitem__",
          [](const Block& self, py::handle key) { return self.values.attr("__getitem__")(key); },
          py::arg("key"), doc::Block_getitem)
      .def(
          "__array__",
          [](const Block& self, py::handle dtype) {
            return py::module_::import("numpy").attr("asarray")(self.values, dtype);
          },
          py::arg("dtype") = py::none(), doc::Block_array)
      .def("__repr__", [](const Block& self) {
        return "<splinecast.Block of " + std::to_string(self.size()) + " times, revision " +
               std::to_string(self.revision) + '>';
      });
}

}  // namespace

Sample::Sample(std::size_t dimensions) : state(dimensions) {
  const StateRef all = state.ref();
  for (const auto& values : {all.position, all.velocity, all.acceleration, all.jerk}) {
    std::ranges::fill(values, kNaN);
  }
}

Block::Block(std::size_t times, Derivatives set, std::size_t dimensions)
    : values(py::dtype::of<double>(), std::vector<std::size_t>{times, count(set), dimensions}),
      status(py::dtype::of<std::uint8_t>(), std::vector<std::size_t>{times}),
      derivatives(set) {}

Block::Block(const py::array& given, std::size_t dimensions)
    : values(given),
      status(py::dtype::of<std::uint8_t>(), std::vector<py::ssize_t>{given.shape(0)}),
      derivatives(Derivatives::all) {
  constexpr py::ssize_t kDerivatives = 4;
  const bool fits = given.ndim() == 3 && given.shape(1) == kDerivatives &&
                    given.shape(2) == static_cast<py::ssize_t>(dimensions);
  const bool is_plain = py::isinstance<py::array_t<double, py::array::c_style>>(given) &&
                        (given.flags() & py::array::c_style) != 0 && given.writeable();
  if (fits && is_plain) return;
  throw BadRequest(
      "out must be a Block, or a writeable contiguous array of float64 of shape (n, 4, " +
      std::to_string(dimensions) + "), not " + std::string(py::str(given.dtype())) +
      std::string(py::str(given.attr("shape"))));
}

SampleBlock Block::memory() {
  return {.values = memory_of(values),
          .status = {static_cast<SampleStatus*>(status.mutable_data()), size()},
          .derivatives = derivatives};
}

void Block::clear_invalid() {
  const std::span seen(static_cast<const SampleStatus*>(status.data()), size());
  if (std::ranges::all_of(seen, [](SampleStatus s) { return has_values(s); })) return;
  const std::size_t stride = static_cast<std::size_t>(values.size()) / size();
  for (std::size_t i = 0; i < size(); ++i) {
    if (has_values(seen[i])) continue;
    std::ranges::fill(memory_of(values).subspan(i * stride, stride), kNaN);
  }
}

Derivatives derivatives(const std::string& text) {
  auto set = Derivatives::none;
  std::size_t next = 0;
  for (const char letter : text) {
    const std::size_t at = kLetters.find(letter, next);
    if (at == std::string_view::npos) {
      throw BadRequest("derivatives: '" + text + "' is not letters of 'pvaj' in this order");
    }
    set = set | static_cast<Derivatives>(1U << at);
    next = at + 1;
  }
  if (text.empty()) throw BadRequest("derivatives must have at least one letter of 'pvaj'");
  return set;
}

void define_samples(py::module_& module) {
  define_state(module);
  define_block(module);
}

}  // namespace splinecast::python
