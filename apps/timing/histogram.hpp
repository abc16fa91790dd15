#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A histogram of times to three significant digits, with the cells of an HdrHistogram of this
/// precision (Tene, hdrhistogram.org): the width of a cell is 1 ns below 2048 ns, and at most
/// 1/1024 of its value above. Debian has no C or C++ library for it. Grows with the largest time,
/// to at most 400 KiB.
class Histogram {
 public:
  /// The first 2048 cells have one width; then every 1024 cells are twice as wide as those before.
  static constexpr int kCellBits = 11;
  static constexpr std::int64_t kCells = std::int64_t{1} << kCellBits;
  /// The longest time: longer ones count as this one, negative ones as 0.
  static constexpr std::int64_t kLongest = (std::int64_t{1} << 62) - 1;
  /// Number of cell widths up to the longest time: the buckets of HdrHistogram.
  static constexpr int kBuckets = 62 - kCellBits + 1;

  void record(Time time);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  /// The exact least and greatest time; 0 if there is none.
  [[nodiscard]] Time least() const noexcept { return least_; }
  [[nodiscard]] Time greatest() const noexcept { return greatest_; }

  /// Mean and standard deviation in ns, from the midpoints of the cells; 0 if there is no time.
  [[nodiscard]] double mean() const noexcept;
  [[nodiscard]] double deviation() const noexcept;

  /// The time of this rank, 1 (least) to count() (greatest): the end of its cell, or greatest() if
  /// that is less. O(cells).
  [[nodiscard]] Time at_rank(std::uint64_t rank) const noexcept;

  /// The counts by cell, up to the last one that is not 0.
  [[nodiscard]] const std::vector<std::uint64_t>& counts() const noexcept { return counts_; }

  /// First and last time of a cell, in ns.
  [[nodiscard]] static std::int64_t first_of(std::size_t cell) noexcept;
  [[nodiscard]] static std::int64_t last_of(std::size_t cell) noexcept;

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  Time least_{};
  Time greatest_{};
};

}  // namespace splinecast::apps
