#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// A reader's own copies of the segments it used last: the knots, with the tags of the revisions
/// that wrote them, and the polynomials made from them. While those tags are unchanged, a copy is
/// used again without copying anything. One thread uses it. Allocates only when constructed.
class KeptSegments {
 public:
  /// Number of copies kept; there is one more to copy into.
  static constexpr std::size_t kMost = 16;

  /// The part of the confirmed current copy that most samples need: the time interval of its
  /// segment, and whether the curve is finished. The interval is empty for a stop or a hold.
  struct CurrentInterval {
    Time left{};
    Time right{};
    bool is_finished = false;
  };

  KeptSegments(std::size_t dimensions, bool smooths);
  KeptSegments(const KeptSegments&) = delete;
  KeptSegments& operator=(const KeptSegments&) = delete;
  KeptSegments(KeptSegments&&) noexcept = default;
  KeptSegments& operator=(KeptSegments&&) noexcept = default;
  ~KeptSegments() = default;

  /// The copy used last; may be empty, or no longer current.
  [[nodiscard]] const BoardSegment& current() const noexcept { return current_->segment; }

  /// The newest revision that the current copy is known to be part of; 0: none.
  [[nodiscard]] Word confirmed_by() const noexcept { return confirmed_; }

  [[nodiscard]] const CurrentInterval& current_interval() const noexcept {
    return current_interval_;
  }

  /// settled_until of that revision, as last seen.
  [[nodiscard]] Time settled_until() const noexcept { return settled_until_; }
  void see_settled(Time settled_until) noexcept { settled_until_ = settled_until; }

  /// A copy that is not kept, to copy into.
  [[nodiscard]] BoardSegment& spare() noexcept { return copies_[spare_].segment; }

  /// Whether the current copy is part of the summary's revision. If it is, records that it is
  /// confirmed by this revision. Copies nothing.
  [[nodiscard]] bool is_confirmed(const KnotBoardReader& board, const Summary& summary) noexcept;

  /// Makes the segment that begins at knot `number`, or at the knot before if none begins there,
  /// the current copy; on failure the current copy stays. O(D), and O(1) if it is kept.
  [[nodiscard]] bool take(const KnotBoardReader& board, const Summary& summary,
                          Word number) noexcept;

 private:
  /// A copy of a segment, and the newest revision that it is known to be part of.
  struct Kept {
    BoardSegment segment;
    Word known_by = 0;
  };

  /// The index of the copy of segment `number`, if it is kept.
  [[nodiscard]] std::uint8_t& place_of(Word number) noexcept { return places_[number % kMost]; }
  void confirm(const Summary& summary) noexcept;
  void confirm(Kept& copy, const Summary& summary) noexcept;

  Word confirmed_ = 0;    ///< a copy of current_->known_by; 0: none
  Time settled_until_{};  ///< settled_until of that revision, as last seen
  CurrentInterval current_interval_;
  std::vector<Kept> copies_;                  ///< kMost of them, and a spare one
  std::array<std::uint8_t, kMost> places_{};  ///< index into copies_, by segment number mod kMost
  std::size_t spare_ = kMost;                 ///< index of the spare copy
  Kept* current_;                             ///< the one used last
};

}  // namespace splinecast::ipc
