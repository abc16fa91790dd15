#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/sampling/segment_values.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// A sample of an executed curve.
struct ExecutedSample {
  SampleStatus status{};
  std::optional<SegmentKind> kind{};  ///< of the segment; empty if the status has no values
};

/// The settled curve of a stream, from its creation to its removal, as a recording has it: what
/// its readers got. It can have gaps, where segments are not in the file.
class ExecutedCurve {
 public:
  /// `options` have a solver.
  explicit ExecutedCurve(StreamOptions options);

  /// Takes the next settled segment of the file. Segments that it replaces, because it begins
  /// before them, are dropped.
  void take(ipc::SegmentCopy segment);

  /// Takes what the stream had published at `host`, CLOCK_MONOTONIC for a live stream.
  void take(Published published, Time host);

  /// The options that the file has last: a standby may have taken over.
  void set_options(StreamOptions options) { options_ = std::move(options); }
  [[nodiscard]] const StreamOptions& options() const noexcept { return options_; }
  [[nodiscard]] const ipc::RegionHeader& header() const noexcept { return *options_.spline; }
  [[nodiscard]] bool is_empty() const noexcept { return segments_.empty() && !open(); }

  /// Settled to their ends, oldest first. Between two of them can be a gap.
  [[nodiscard]] std::span<const ipc::SegmentCopy> segments() const noexcept { return segments_; }

  /// The segment after the last one of these, as far as it has settled; null if it is not known.
  [[nodiscard]] const ipc::OpenSegment* open() const noexcept;

  /// Where the curve begins. Requires that it is not empty.
  [[nodiscard]] Time begin() const noexcept;

  /// The sample `fraction` seconds after t, with the bits that a reader got, if it sampled t when
  /// the host's time was `host`. A time in a gap, or after what the file has, is `no_data`; a time
  /// before it `before_history`. O(log n + D).
  [[nodiscard]] ExecutedSample sample(Time t, double fraction, Time host,
                                      const StateRef& out) const noexcept;

  /// Its parts without a gap, in stream time.
  [[nodiscard]] std::vector<PiecewisePolynomial> parts() const;

 private:
  [[nodiscard]] ExecutedSample sample_last(Time t, const ipc::SegmentView& last,
                                           const StateRef& out) const noexcept;
  [[nodiscard]] SampleStatus status_in(const ipc::SegmentView& segment, Time host) const noexcept;

  StreamOptions options_;
  DimensionKinds kinds_;
  bool is_live_;
  std::vector<ipc::SegmentCopy> segments_;
  Published published_;                 ///< last
  std::optional<Time> finished_since_;  ///< host time
};

/// The point of a recorded time law at a host time; nothing if the file does not have it.
[[nodiscard]] std::optional<ipc::LawPoint> law_point(const ExecutedCurve& law, Time host) noexcept;

}  // namespace splinecast::apps::record
