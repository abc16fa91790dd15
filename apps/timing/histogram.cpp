#include "apps/timing/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace splinecast::apps {
namespace {

/// log₂ of the width of the cell that holds a time.
int width_bits(std::int64_t ns) noexcept {
  return std::max(
      0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(ns))) - Histogram::kCellBits);
}

/// The index of the cell of a time. The first kCells cells are 1 ns wide; after them, each group of
/// kCells/2 cells is twice as wide as the group before.
std::size_t cell_of(std::int64_t ns) noexcept {
  const int bits = width_bits(ns);
  return static_cast<std::size_t>((bits * Histogram::kCells / 2) + (ns >> bits));
}

int width_bits_of_cell(std::size_t cell) noexcept {
  return std::max(0, static_cast<int>(cell >> (Histogram::kCellBits - 1)) - 1);
}

double middle_of(std::size_t cell) noexcept {
  const std::int64_t half = (std::int64_t{1} << width_bits_of_cell(cell)) >> 1;
  return static_cast<double>(Histogram::first_of(cell) + half);
}

}  // namespace

std::int64_t Histogram::first_of(std::size_t cell) noexcept {
  const int bits = width_bits_of_cell(cell);
  return (static_cast<std::int64_t>(cell) - bits * kCells / 2) << bits;
}

std::int64_t Histogram::last_of(std::size_t cell) noexcept {
  return first_of(cell) + (std::int64_t{1} << width_bits_of_cell(cell)) - 1;
}

void Histogram::record(Time time) {
  const std::int64_t ns = std::clamp<std::int64_t>(time.count(), 0, kLongest);
  const std::size_t cell = cell_of(ns);
  if (cell >= counts_.size()) counts_.resize(cell + 1);
  ++counts_[cell];
  least_ = count_ == 0 ? Time(ns) : std::min(least_, Time(ns));
  greatest_ = std::max(greatest_, Time(ns));
  ++count_;
}

double Histogram::mean() const noexcept {
  if (count_ == 0) return 0;
  double sum = 0;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    sum += static_cast<double>(counts_[cell]) * middle_of(cell);
  }
  return sum / static_cast<double>(count_);
}

double Histogram::deviation() const noexcept {
  if (count_ == 0) return 0;
  const double middle = mean();
  double sum = 0;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    const double distance = middle_of(cell) - middle;
    sum += static_cast<double>(counts_[cell]) * distance * distance;
  }
  return std::sqrt(sum / static_cast<double>(count_));
}

Time Histogram::at_rank(std::uint64_t rank) const noexcept {
  std::uint64_t below = 0;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    below += counts_[cell];
    if (below >= rank) return std::min(Time(last_of(cell)), greatest_);
  }
  return greatest_;
}

}  // namespace splinecast::apps
