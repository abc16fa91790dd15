#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

/// Records of the C++ interface as those of records.py.
namespace splinecast::python {

namespace py = pybind11;

/// `text` is the excess in words.
[[nodiscard]] py::object to_record(const LimitExcess& excess, const std::string& text);
[[nodiscard]] py::object to_record(const Excess& excess);
/// Names are those of the dimensions, or none.
[[nodiscard]] py::object to_record(const ItemRefusal& refusal, std::span<const std::string> names);
[[nodiscard]] py::object to_record(const Refusals& refusals, std::span<const std::string> names);
[[nodiscard]] py::object to_record(const ItemOutcome& outcome);
[[nodiscard]] py::object to_record(const std::optional<ReplacementBegin>& found);
[[nodiscard]] py::object to_record(const ReplacePreview& preview);
[[nodiscard]] py::object to_record(const LawRate& rate);
[[nodiscard]] py::object to_record(const StepResult& result);
[[nodiscard]] py::object to_record(const std::optional<CurveProgress>& progress);
[[nodiscard]] py::object to_record(const SnapshotSegment& segment, std::size_t dimensions);
[[nodiscard]] py::dict to_record(const MotionLimits& limits);

}  // namespace splinecast::python
