#pragma once

#include "fuzz/script.hpp"
#include "splinecast/ipc/sampler.hpp"

namespace splinecast::fuzz {

/// Samples a board and checks each answer.
class Sampling {
 public:
  Sampling(const ipc::SegmentBoardReader& board, ipc::Sampler& sampler);

  /// At the ends of the segments that the board keeps, beside and between them, and at the ends of
  /// time.
  void tour();

  /// Once at t, as executed or not. With values, none may be infinite or no number.
  void sample(core::Time t, bool preview);

  /// Segments between two times.
  void snapshot(core::Time from, core::Time to);

  /// A time near an end of a segment, or any.
  [[nodiscard]] core::Time pick(Script& script);

 private:
  const ipc::SegmentBoardReader* board_;
  ipc::Sampler* sampler_;
  core::State state_;
  ipc::Snapshot snapshot_;
};

}  // namespace splinecast::fuzz
