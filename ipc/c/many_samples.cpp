#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

#include "ipc/arguments/enums.hpp"
#include "ipc/c/roles.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

constexpr const char* kValues = "values";

/// Checks the room for the values of `times` times.
Rows<double> require_room(const splinecast_output_matrix* values, std::size_t times,
                          std::size_t columns) {
  require_pointer(values, kValues);
  if (times > 0) require_pointer(values->data, kValues);
  const Rows<double> rows(values->data, values->rows, values->columns, values->row_stride,
                          values->column_stride, kValues);
  if (values->rows != times) {
    refuse(kValues, "has " + std::to_string(values->rows) + " rows, not one for each of " +
                        std::to_string(times) + " times");
  }
  if (times > 0 && values->columns != columns) {
    refuse(kValues,
           "has " + std::to_string(values->columns) + " columns, not " + std::to_string(columns));
  }
  return rows;
}

void require_statuses(const uint8_t* statuses, std::size_t count, std::size_t times) {
  if (times > 0) require_pointer(statuses, "statuses");
  if (count == times) return;
  refuse("statuses", "has " + std::to_string(count) + " elements, not " + std::to_string(times));
}

/// Memory of the handle for `count` elements, which grows if it is too small.
template <typename T>
std::span<T> room(std::vector<T>& memory, std::size_t count) {
  if (memory.size() < count) memory.resize(count);
  return std::span(memory).first(count);
}

/// The memory that the evaluation writes to: the program's, or the handle's.
std::span<double> target(splinecast_reader& own, const Rows<double>& rows, std::size_t columns) {
  if (rows.is_contiguous()) return rows.span();
  std::size_t count = 0;
  if (__builtin_mul_overflow(rows.size(), columns, &count)) refuse(kValues, "is too large");
  return room(own.values, count);
}

void copy_back(std::span<const double> from, const Rows<double>& rows, std::size_t columns) {
  if (rows.is_contiguous()) return;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t c = 0; c < columns; ++c) rows.at(i, c) = from[i * columns + c];
  }
}

}  // namespace

extern "C" int splinecast_reader_sample_many(splinecast_reader* reader,
                                             const splinecast_times* times, int derivatives,
                                             const splinecast_output_matrix* values,
                                             uint8_t* statuses, size_t status_count,
                                             uint64_t* revision) {
  return guarded([&] {
    splinecast_reader& own = require_handle(reader, "reader");
    const Stamps stamps = require_times(*require_pointer(times, "times"), "times");
    if (derivatives == 0) refuse("derivatives", "is 0, not 1 to 15");
    const auto set = static_cast<Derivatives>(
        require_choice(derivatives, SPLINECAST_ALL_VALUES + 1, "derivatives"));
    const std::size_t columns = count(set) * own.reader.dimensions();
    const Rows<double> rows = require_room(values, stamps.size(), columns);
    require_statuses(statuses, status_count, stamps.size());
    if (revision != nullptr) require_pointer(revision, "revision");

    const auto at = room(own.times, stamps.size());
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = Time(stamps[i]);
    const SampleBlock block{.values = target(own, rows, columns),
                            .status = room(own.statuses, stamps.size()),
                            .derivatives = set};
    const std::uint64_t found = own.reader.sample_many(at, block);
    if (found != 0) copy_back(block.values, rows, columns);
    std::ranges::transform(block.status, statuses,
                           [](SampleStatus one) { return static_cast<uint8_t>(one); });
    if (revision != nullptr) *revision = found;
    return found != 0 ? 1 : 0;
  });
}
