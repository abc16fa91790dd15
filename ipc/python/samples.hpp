#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "splinecast/snapshot.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"

namespace splinecast::python {

namespace py = pybind11;

/// The Python class State: NaN until a sample writes it.
struct Sample {
  explicit Sample(std::size_t dimensions);

  State state;
  SampleStatus status = SampleStatus::no_data;
  Time time{};
};

/// The Python class Block.
struct Block {
  Block(std::size_t times, Derivatives set, std::size_t dimensions);
  /// All derivatives, in the memory of an array of float64. Throws BadRequest unless it is of shape
  /// (n, 4, dimensions), contiguous and writeable.
  Block(const py::array& values, std::size_t dimensions);

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(status.size()); }
  /// The memory of the arrays, for Reader::sample_many.
  [[nodiscard]] SampleBlock memory();
  /// Overwrites values without a valid status by NaN.
  void clear_invalid();

  py::array values;
  py::array status;
  Derivatives derivatives;
  std::uint64_t revision = 0;
  std::vector<Time> scratch;  ///< times in ns, if they are given as floats
};

/// The set for letters of `pvaj`, in this order. Throws BadRequest for other text.
[[nodiscard]] Derivatives derivatives(const std::string& text);

}  // namespace splinecast::python
