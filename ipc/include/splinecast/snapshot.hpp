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

/// Where `sample_many` writes: N times, D dimensions, and as many derivatives as are asked for.
struct SampleBlock {
  std::span<double> values;        ///< [time][derivative asked for, position first][dimension]
  std::span<SampleStatus> status;  ///< one per time; those without values leave theirs undefined
  Derivatives derivatives = Derivatives::all;
};

/// One segment of a snapshot: a polynomial in u = t − left seconds. A view into its snapshot.
struct SnapshotSegment {
  Time left{};
  Time right{};                          ///< where the next segment begins, or this one ends
  int order = kCubicOrder;               ///< coefficients per dimension
  SegmentKind kind{};                    ///< what the segment is for
  std::span<const double> coefficients;  ///< [power][dimension], lowest power first
  std::span<const double> waypoint;      ///< position of the waypoint at `left`; empty: none there
  std::span<const double> acceleration_step;  ///< a⁺ − a⁻ at `left`; empty where the board no
                                              ///< longer has the segment before it
};

/// Several segments of one revision: a consistent piece of the curve, whole or not at all. Made by
/// Reader::snapshot. One thread uses it.
class Snapshot {
 public:
  /// Allocates as it grows; reuse one to allocate no more.
  explicit Snapshot(std::size_t dimensions);
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;
  ~Snapshot();

  [[nodiscard]] std::size_t dimensions() const noexcept;

  /// Segments that it holds.
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
