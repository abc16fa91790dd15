#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "ipc/arguments/arrays.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// Where a C program wants a state: checked. An evaluation writes to ref(); put() copies to the
/// outputs that have a stride. What is not wanted is written to this object only.
class StateTarget {
 public:
  /// `out` is the name of the argument.
  StateTarget(const splinecast_state* out, std::size_t dimensions);
  StateTarget(const StateTarget&) = delete;
  StateTarget& operator=(const StateTarget&) = delete;

  [[nodiscard]] const StateRef& ref() const noexcept { return ref_; }
  void put() const noexcept;

 private:
  std::span<double> target(std::size_t derivative) noexcept;

  std::size_t dimensions_;
  std::array<Outputs, 4> outputs_;
  StateRef ref_;
  std::array<double, 4 * kMaxDimensions> copies_;  ///< only what is copied is written
};

/// Reads a state of a C program, which must have all four derivatives. `sampled` is the name of the
/// argument.
void read_state(const splinecast_state* sampled, State& to);

}  // namespace splinecast::ipc
