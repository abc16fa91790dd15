#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/motion/plan.hpp"
#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/solve/knot_writer.hpp"
#include "splinecast/state.hpp"

namespace splinecast::ipc {

/// Reads a plan back from the board: for a solver that takes over, and for one that has discarded a
/// revision. Checks everything that it reads. Allocates only when constructed; one thread uses it.
class PlanReader {
 public:
  /// `published` outlives the reader. `window` has the options of the windows that are restored.
  PlanReader(const KnotBoardReader& published, const core::SlidingWindow& window);

  /// Reads the plan of an unfinished stream's last commit, whose summary is `summary`. Returns
  /// false if the board holds data that no solver wrote. O(K·D).
  [[nodiscard]] bool read(const Summary& summary) noexcept;

  /// What was read last. The spans are valid until the next call.
  [[nodiscard]] const core::PlanState& state() const noexcept { return state_; }
  [[nodiscard]] std::span<const core::Knot> knots() const noexcept {
    return std::span(knots_).last(count_);
  }
  [[nodiscard]] const CurveOrigin& origin() const noexcept { return origin_; }

 private:
  [[nodiscard]] bool read_course() noexcept;
  [[nodiscard]] bool read_origin(Word number) noexcept;
  [[nodiscard]] bool read_ahead(core::EnteringAhead& ahead, Word& number) noexcept;
  [[nodiscard]] bool read_knots() noexcept;
  [[nodiscard]] bool read_knot(Word number) noexcept;
  [[nodiscard]] bool is_passed(std::size_t i) noexcept;
  [[nodiscard]] std::optional<bool> find_knot(std::size_t i, Word& number) noexcept;
  [[nodiscard]] core::Knot to_knot(std::span<double> values) noexcept;

  /// Values of a knot that a window is restored from: waypoint, g, position, velocity, acceleration
  /// and residual of D each.
  static constexpr std::size_t kKnotValues = 6;

  const KnotBoardReader* published_;
  Summary summary_;
  core::PlanState state_;
  CurveOrigin origin_;
  State origin_state_;
  State entry_end_;
  KnotCopy knot_;  ///< read last
  std::vector<core::Knot> knots_;
  std::size_t count_ = 0;  ///< of them, the last ones
  std::vector<double> values_;
};

}  // namespace splinecast::ipc
