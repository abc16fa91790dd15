#pragma once

#include <cstdint>
#include <vector>

#include "apps/record/format/loss.hpp"

namespace splinecast::campaign::record {

/// A set of numbers, as ranges.
class Ranges {
 public:
  using Span = apps::record::NumberSpan;

  void add(const Span& range);
  void add(const Ranges& other);

  /// Sorts and joins the ranges. Returns how many numbers were in it more than once.
  std::uint64_t tidy();

  // The rest needs tidy() before.

  [[nodiscard]] std::uint64_t count() const noexcept;
  /// The number after the largest one.
  [[nodiscard]] std::uint64_t end() const noexcept;
  /// How many numbers below `end` are not in it.
  [[nodiscard]] std::uint64_t missing(std::uint64_t end) const noexcept;
  /// How many numbers are in both.
  [[nodiscard]] std::uint64_t common(const Ranges& other) const;
  /// The first number below `end` that is not in it, for a message.
  [[nodiscard]] std::uint64_t first_missing() const noexcept;

 private:
  std::vector<Span> ranges_;
};

}  // namespace splinecast::campaign::record
