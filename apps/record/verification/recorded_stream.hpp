#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "apps/record/verification/coverage.hpp"
#include "ipc/verification/sent_items.hpp"
#include "ipc/verification/verify.hpp"

namespace splinecast::apps::record {

/// What verification has found in a recorded stream.
struct StreamVerification {
  std::uint64_t segments = 0;                  ///< recorded
  std::uint64_t equal = 0;                     ///< solved again, and equal
  std::uint64_t parts = 0;                     ///< parts without a gap
  std::array<LossCounts, kLossCauses> lost{};  ///< what the recorder could not record, by cause
  std::uint64_t items = 0;                     ///< recorded
  std::optional<std::uint64_t> sent{};  ///< number of the ring's items that the file accounts for
  std::uint64_t unaccounted = 0;        ///< of these, neither in the file nor lost; 0 unless the
                                        ///< file is damaged or cut off
  std::uint64_t late_commits = 0;       ///< places where a late commit ends a part
  std::optional<ipc::Difference> first{};  ///< the first difference

  /// Segments that could not be solved again, because something before them is not in the file.
  [[nodiscard]] std::uint64_t unverified() const noexcept { return segments - equal; }
  [[nodiscard]] LossCounts all_lost() const noexcept { return Account{.lost = lost}.all_lost(); }
  /// Whether the stream is there as a whole, and all of it was compared.
  [[nodiscard]] bool is_complete() const noexcept {
    return unverified() == 0 && all_lost().all() == 0 && unaccounted == 0;
  }
};

/// Collects the messages of a stream's exact channel, and solves each part without a gap again.
/// Needs the memory of a part: a part is solved when it has kMostSegments and the next one can
/// begin. One thread uses it.
class RecordedStream {
 public:
  static constexpr std::size_t kMostSegments = 100'000;

  /// Takes the next message. Throws BadMessage for one that a recorder does not write.
  void take(std::span<const std::byte> message);

  /// Solves what has been collected. Call it after the last message.
  void finish();

  [[nodiscard]] const StreamVerification& found() const noexcept { return found_; }
  [[nodiscard]] const std::optional<StreamOptions>& options() const noexcept { return options_; }

 private:
  /// A part of the stream, from a start on.
  struct Part {
    // No initialisers: with them, clang 14 refuses std::optional<Part> as a member of this class.
    std::optional<Restart> restart;  ///< empty: from the beginning of the stream
    std::vector<ipc::SegmentCopy> segments;
  };
  struct Item {
    ipc::RingItem item;
    bool is_refused = false;
  };

  void take_options(std::span<const std::byte> body);
  void take_item(NumberedItem item);
  void take_segment(ipc::SegmentCopy segment);
  void take_restart(Restart restart);
  void take_loss(const Loss& loss);
  void take_account(const Account& account);
  void settle_account();
  void begin(std::optional<Restart> restart);
  void end_part();
  void verify_part();
  [[nodiscard]] bool has_items_from(ipc::Word first) const noexcept;
  [[nodiscard]] ipc::SentItems sent_items() const;
  [[nodiscard]] Condition end() const;

  std::optional<StreamOptions> options_;
  std::map<ipc::Word, Item> items_;   ///< by number
  ipc::Word items_end_ = 0;           ///< the number after the newest item
  ipc::Word complete_from_ = 0;       ///< all items from this one on are here
  Coverage covered_;                  ///< items that are here or lost
  std::optional<ipc::Word> first_{};  ///< the first item that has to be here or lost
  std::optional<Account> account_{};  ///< the last one of this stream
  ipc::Summary summary_;              ///< the last one of this stream
  std::optional<Part> part_;
  ipc::Word next_segment_ = 1;  ///< number of the segment that should follow
  StreamVerification found_;
};

}  // namespace splinecast::apps::record
