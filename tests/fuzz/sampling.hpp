#pragma once

#include <array>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {

/// Samples a board and checks each answer.
class Sampling {
 public:
  Sampling(const ipc::KnotBoardReader& board, ipc::Sampler& sampler);

  /// At the ends of the segments that the board keeps, beside and between them, and at the ends of
  /// time.
  void tour();

  /// Once at t, as executed or not. With values, none may be infinite or no number.
  void sample(Time t, bool preview);

  /// At these times under one revision, with these derivatives.
  void sample_many(std::span<const Time> times, Derivatives asked);

  /// Segments between two times.
  void snapshot(Time from, Time to);

  /// A time near an end of a segment, or any.
  [[nodiscard]] Time pick(Script& script);

 private:
  /// The ends of a segment, and where it would end had it not been cut, and the middle.
  using Marks = std::array<Time, 4>;
  [[nodiscard]] bool find_marks(const ipc::Head& head, ipc::Word number, Marks& marks);

  const ipc::KnotBoardReader* board_;
  ipc::Sampler* sampler_;
  State state_;
  ipc::BoardSnapshot snapshot_;
  ipc::BoardSegment segment_;
  std::vector<double> values_;
  std::vector<SampleStatus> statuses_;
};

}  // namespace splinecast::fuzz
