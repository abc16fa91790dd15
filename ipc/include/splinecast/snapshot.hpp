#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {
class BoardSnapshot;
}  // namespace splinecast::ipc

namespace [[gnu::visibility("default")]] splinecast {

/// The output of `sample_many`: N times, D dimensions and the selected derivatives.
struct SampleBlock {
  std::span<double> values;        ///< [time][derivative, position first][dimension]
  std::span<SampleStatus> status;  ///< one per time; a status without values leaves its values
                                   ///< undefined
  Derivatives derivatives = Derivatives::all;
};

/// One segment of a snapshot: a polynomial in u = t − left seconds. A view into its snapshot.
struct SnapshotSegment {
  Time left{};
  Time right{};                          ///< right end; the next segment begins there
  int order = kCubicOrder;               ///< coefficients per dimension
  SegmentKind kind{};                    ///< spline, entry, stop, …: see SegmentKind
  std::span<const double> coefficients;  ///< [power][dimension], lowest power first
  std::span<const double> waypoint;      ///< position of the waypoint at `left`; empty: none there
  std::span<const double> acceleration_step;  ///< a⁺ − a⁻ at `left`; empty if the board no longer
                                              ///< has the segment before it
  bool is_corner = false;  ///< the curve was cut at `left` while its time law held it, and begins
                           ///< at rest: the velocity may step there
};

/// Consecutive segments of one revision: a consistent part of the curve, complete or empty. Made by
/// Reader::snapshot. One thread uses it.
class Snapshot {
 public:
  /// Allocates when it grows; reuse one to avoid allocation.
  explicit Snapshot(std::size_t dimensions);
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;
  ~Snapshot();

  [[nodiscard]] std::size_t dimensions() const noexcept;

  /// Number of segments.
  [[nodiscard]] std::size_t size() const noexcept;

  /// Segment i < size(), oldest first. O(1).
  [[nodiscard]] SnapshotSegment operator[](std::size_t i) const noexcept;

  /// The revision that all segments belong to; 0: none.
  [[nodiscard]] std::uint64_t revision() const noexcept;

  /// The time before which no later revision changes the curve.
  [[nodiscard]] Time settled_until() const noexcept;

 private:
  friend class Reader;
  std::unique_ptr<ipc::BoardSnapshot> board_;
};

}  // namespace splinecast
