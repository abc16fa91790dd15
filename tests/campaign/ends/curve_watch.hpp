#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"
#include "tests/campaign/ends/tally.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::campaign::ends {

/// Checks every revision of a life on the curve that it publishes.
class CurveWatch {
 public:
  CurveWatch(const LifePlan& plan, testing::MemoryStream& stream, Tally& tally);

  /// Checks the newest revision if it is new. Call it after each step. `rests` is the time after
  /// which a law that holds the stream allows changes; max() if none does.
  void look(Time rests = Time::max());

  /// Checks that the board still has the pieces that were seen, and that each waypoint is
  /// interpolated or passed over. Call it at the end of a life.
  void check_all();

  /// Notes that the motion is replaced by another one, or by a stop.
  void note_replacement() noexcept { is_replaced_ = true; }

  [[nodiscard]] const ipc::Summary& summary() const noexcept { return summary_; }
  [[nodiscard]] bool has_curve() const noexcept { return !pieces_.empty(); }
  [[nodiscard]] Time begin() const noexcept { return pieces_.front().left; }
  [[nodiscard]] Time end() const noexcept { return pieces_.empty() ? Time::min() : last().right; }
  /// The piece at t, the first or the last one outside of the curve. Requires has_curve().
  [[nodiscard]] const Piece& at(Time t) const noexcept { return at(pieces_, t); }
  [[nodiscard]] const PieceRanges& ranges() const noexcept { return ranges_; }

 private:
  [[nodiscard]] const Piece& last() const noexcept { return pieces_.back(); }
  [[nodiscard]] static const Piece& at(std::span<const Piece> pieces, Time t) noexcept;
  [[nodiscard]] static const Piece* find(std::span<const Piece> pieces, ipc::Word number) noexcept;
  [[nodiscard]] bool read(ipc::Word from, std::vector<Piece>& out);
  void check_curve(Time settled, bool finishes);
  void check_counts(const ipc::Summary& before);
  void check_excesses(const ipc::Summary& before, Time settled);
  void check_settled(std::span<const Piece> old, Time settled);
  void check_joint(const Piece& before, const Piece& after);
  void check_rest();
  void show(const Piece& piece);
  void check_piece(const Piece& piece, const Piece* former, bool finishes);
  void check_stop(const Piece& piece, const Peaks& peaks);
  void check_stop_limits(const Piece& piece, const Peaks& peaks, std::size_t d);
  void check_entry(const Piece& piece, const Peaks& peaks, bool finishes);
  void check_entry_bounds(const Piece& piece, const Peaks& peaks, Time until, Rule rule);
  [[nodiscard]] double shown(std::size_t d) const;
  void check_shown(const Piece& piece, const Piece* former, Rule rule);
  void check_spline(const Piece& piece, const Peaks& peaks, const Piece* former);
  void check_no_worse(const Piece& piece, const Peaks& peaks, const Piece& former);
  [[nodiscard]] double seconds_to(const Piece& piece) const;
  [[nodiscard]] bool is_at(std::size_t waypoint, const Piece& piece, double u) const;
  void check_met();
  void check_end();
  void check_last_entry();
  [[nodiscard]] bool is_of_kind(ipc::EndKind kind) const;
  [[nodiscard]] bool rests_at_newest() const;
  [[nodiscard]] Time newest_waypoint() const;
  void measure_slowing();
  void breach(Rule rule, const Piece& piece, const std::string& what);

  const LifePlan* plan_;
  testing::MemoryStream* stream_;
  Tally* tally_;
  PieceRanges ranges_;
  const MotionLimits* limits_;
  ipc::BoardSegment segment_;
  ipc::Summary summary_;
  std::vector<Piece> pieces_;  ///< the published curve, from its begin on
  std::vector<Piece> old_;     ///< the curve of the revision before, without what had settled
  std::vector<Piece> fresh_;   ///< scratch
  bool is_replaced_ = false;
  bool is_cut_ = false;                                 ///< this revision has begun a run
  bool knows_path_ = false;                             ///< this revision has accepted no waypoint
  std::array<double, kMostDimensions> velocity_{};      ///< shown by waypoints and curve
  std::array<double, kMostDimensions> acceleration_{};  ///< the same
  std::array<double, kMostDimensions> entered_{};       ///< accelerations of entries
};

}  // namespace splinecast::campaign::ends
