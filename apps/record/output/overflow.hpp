#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/watch/batch.hpp"

namespace splinecast::apps::record {

/// What stays of batches for which the queue had no room: the options of streams, without which
/// nothing of them can be written, that a stream has ended, and what was lost, by stream. One
/// thread uses it.
class Overflow {
 public:
  /// Above this number of options no further stream should be attached.
  static constexpr std::size_t kMostOptions = 1000;

  /// Takes a batch and empties it.
  void take(Batch& batch);

  /// Puts what stays before the records of a batch.
  void prepend_to(Batch& batch);

  [[nodiscard]] bool is_empty() const noexcept { return kept_.records.empty() && losses_.empty(); }
  [[nodiscard]] bool is_full() const noexcept { return options_ >= kMostOptions; }

 private:
  void put_losses(std::uint32_t stream);

  Batch kept_;
  std::size_t options_ = 0;
  std::map<std::uint32_t, LossList> losses_;  ///< after the stream's records in kept_
};

}  // namespace splinecast::apps::record
