#pragma once

#include <array>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {

/// Samples a board and checks each result.
class Sampling {
 public:
  Sampling(const ipc::KnotBoardReader& board, ipc::Sampler& sampler);

  /// Samples at, next to and between the ends of the segments on the board, and at the smallest and
  /// largest time.
  void tour();

  /// Samples once at t, as executed or with `preview`. All values must be finite.
  void sample(Time t, bool preview);

  /// Samples these derivatives at these times under one revision.
  void sample_many(std::span<const Time> times, Derivatives asked);

  /// Copies the segments between two times.
  void snapshot(Time from, Time to);

  /// A time near an end of a segment, or any time.
  [[nodiscard]] Time pick(Script& script);

 private:
  /// Left and right end of a segment, its right end without a cut, and its middle.
  using Marks = std::array<Time, 4>;
  [[nodiscard]] bool find_marks(const ipc::Summary& summary, ipc::Word number, Marks& marks);

  const ipc::KnotBoardReader* board_;
  ipc::Sampler* sampler_;
  State state_;
  ipc::BoardSnapshot snapshot_;
  ipc::BoardSegment segment_;
  std::vector<double> values_;
  std::vector<SampleStatus> statuses_;
};

}  // namespace splinecast::fuzz
