#pragma once

#include <memory>

#include "ipc/law/follower.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The times of one stream on the wall clock. Those of a recorded stream stay as they are. One
/// thread uses it.
class StreamTimes {
 public:
  /// `wall_offset`: the wall clock minus CLOCK_MONOTONIC.
  StreamTimes(const ipc::RegionHeader& stream, Time wall_offset);

  /// Follows the law that the stream's header names, if the law is there and was not before.
  void find_law(const ipc::RegionHeader& stream, const Trust& trust);

  /// The stream's time at a time of the wall clock; `otherwise` if the stream has no time of its
  /// own, or if its law cannot be read.
  [[nodiscard]] Time stream_time(Time wall, Time otherwise) const noexcept;

  /// When a time of the stream is or was, on the wall clock. Under a law as the law is known at
  /// `now`, and with rate 1 where it is not known. O(log) reads of the law.
  [[nodiscard]] Time wall_time(Time stream, Time now) const noexcept;

  /// What is added to the times of a live stream without a law; else 0.
  [[nodiscard]] Time offset() const noexcept { return offset_; }

  [[nodiscard]] ipc::LawFollower* law() const noexcept { return law_.get(); }

 private:
  [[nodiscard]] Time by_law(Time stream, Time host) const noexcept;

  bool is_live_;
  Time offset_;
  std::unique_ptr<ipc::LawFollower> law_;
};

}  // namespace splinecast::apps::record
