#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Counts of times to three significant digits, in the cells of an HdrHistogram of that precision
/// (Tene, hdrhistogram.org): from 2048 ns on a cell is at most a 1024th of its value wide, below it
/// is 1 ns. Debian has no C or C++ library of it. Grows as larger times come; 400 KiB at most.
class Histogram {
 public:
  /// Cells of one width but for the first 2048; each next half is twice as wide.
  static constexpr int kCellBits = 11;
  static constexpr std::int64_t kCells = std::int64_t{1} << kCellBits;
  /// What can be told apart: longer times count as this one, negative ones as 0.
  static constexpr std::int64_t kLongest = (std::int64_t{1} << 62) - 1;
  /// Halves that it takes to get there, as HdrHistogram counts its buckets.
  static constexpr int kBuckets = 62 - kCellBits + 1;

  void record(Time time);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  /// The exact least and greatest time; 0 if there is none.
  [[nodiscard]] Time least() const noexcept { return least_; }
  [[nodiscard]] Time greatest() const noexcept { return greatest_; }

  /// Mean and standard deviation in ns, of the cells' middles; 0 if there is no time.
  [[nodiscard]] double mean() const noexcept;
  [[nodiscard]] double deviation() const noexcept;

  /// The time that `rank` of the times do not exceed, 1 ≤ rank ≤ count(): the end of its cell, or
  /// greatest() if that is less. O(cells).
  [[nodiscard]] Time at_rank(std::uint64_t rank) const noexcept;

  /// The counts by cell, up to the last one that is not 0.
  [[nodiscard]] const std::vector<std::uint64_t>& counts() const noexcept { return counts_; }

  /// First and last time, in ns, of a cell.
  [[nodiscard]] static std::int64_t first_of(std::size_t cell) noexcept;
  [[nodiscard]] static std::int64_t last_of(std::size_t cell) noexcept;

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  Time least_{};
  Time greatest_{};
};

}  // namespace splinecast::apps
