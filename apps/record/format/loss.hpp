#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/record/format/record.hpp"
#include "ipc/memory/word.hpp"

/// Losses of a recording, and accounts of what was recorded and lost.
namespace splinecast::apps::record {

/// Why something is not in a file.
enum class LossCause : std::uint8_t {
  overwritten = 0,  ///< the recorder came too late to read it from shared memory
  queue = 1,        ///< the disk was too slow
  file = 2,         ///< the file could not be written
  late_commit = 3,  ///< nothing is lost, but settled segments have been changed
  before = 4,       ///< shared memory no longer had it when the recorder attached
};
inline constexpr std::uint8_t kLossCauses = 5;
[[nodiscard]] std::string_view to_string(LossCause cause) noexcept;

/// Consecutive numbers, of items or of segments.
struct NumberSpan {
  ipc::Word first = 0;
  ipc::Word count = 0;

  [[nodiscard]] ipc::Word end() const noexcept { return first + count; }
  /// Adds a number that follows, or is the first one.
  void extend(ipc::Word from, ipc::Word to) noexcept;
  /// Without the numbers below `least`.
  [[nodiscard]] NumberSpan from(ipc::Word least) const noexcept;
  /// Whether a range continues this one; an empty one does, and every one continues an empty one.
  [[nodiscard]] bool continues_in(const NumberSpan& next) const noexcept {
    return count == 0 || next.count == 0 || next.first == end();
  }
};

/// Something of a stream that is in no file, with its numbers.
struct Loss {
  LossCause cause{};
  NumberSpan items{};
  NumberSpan segments{};  ///< a segment has the numbers from its own to the next one's
  ipc::Word refusals = 0;
  ipc::Word others = 0;  ///< events, restarts and summaries

  [[nodiscard]] ipc::Word all() const noexcept {
    return items.count + segments.count + refusals + others;
  }
  /// Counts a record.
  void count(const Record& record) noexcept;
};
[[nodiscard]] Bytes encode(const Loss& loss);
[[nodiscard]] Loss decode_loss(std::span<const std::byte> bytes);

/// The losses of a stream that are still to be written, by their numbers. Consecutive ones of the
/// same cause are one. Where there are more than kMost, consecutive ones of different causes become
/// one, with the cause of the later: then only the account has each cause. One thread uses it.
class LossList {
 public:
  static constexpr std::size_t kMost = 64;

  void add(const Loss& loss);
  [[nodiscard]] std::span<const Loss> losses() const noexcept { return losses_; }

 private:
  void shorten();

  std::vector<Loss> losses_;
};

/// Numbers of what was lost for one cause.
struct LossCounts {
  ipc::Word items = 0, segments = 0, refusals = 0, others = 0;

  [[nodiscard]] ipc::Word all() const noexcept { return items + segments + refusals + others; }
  LossCounts& operator+=(const LossCounts& other) noexcept;
};

/// Where the items and the segments of a stream are: each number below `end` is counted once.
struct Account {
  struct Numbers {
    ipc::Word end = 0;        ///< of the ring, or of the boards
    ipc::Word recorded = 0;   ///< in a file
    ipc::Word unwritten = 0;  ///< read, and not in a file because no dump was wanted
  };
  Numbers items{};
  Numbers segments{};
  std::array<LossCounts, kLossCauses> lost{};  ///< by cause

  [[nodiscard]] LossCounts all_lost() const noexcept;
  Account& operator+=(const Account& other) noexcept;
};
[[nodiscard]] Bytes encode(const Account& account);
[[nodiscard]] Account decode_account(std::span<const std::byte> bytes);

/// Members `items`, `segments`, `refusals` and `others`.
[[nodiscard]] nlohmann::ordered_json to_json(const LossCounts& counts);
/// These for each cause that has any, by its name.
[[nodiscard]] nlohmann::ordered_json reasons_json(const std::array<LossCounts, kLossCauses>& lost);

/// `5 items lost (overwritten 3, disk 2), 1 segments lost (disk 1)`; `0 items lost`.
[[nodiscard]] std::string lost_in_words(const std::array<LossCounts, kLossCauses>& lost);

}  // namespace splinecast::apps::record
