#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "apps/record/format/bytes.hpp"
#include "apps/record/format/record.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/verification/run_restart.hpp"

/// The messages of the exact channel, byte by byte as docs/file-formats.md describes them. The
/// functions `decode_…` take a message without its first byte, and throw BadMessage for one that is
/// not valid.
namespace splinecast::apps::record {

/// The kind of a message. Throws BadMessage for an unknown kind or an empty message.
[[nodiscard]] RecordKind kind_of(std::span<const std::byte> message);

struct NumberedItem {
  ipc::Word number = 0;
  ipc::RingItem item;
};
[[nodiscard]] Bytes encode(ipc::Word number, const ipc::RingItem& item);
[[nodiscard]] NumberedItem decode_item(std::span<const std::byte> bytes, std::size_t dimensions);
/// The values of an item as a waypoint; positions only if its kind has them. A view.
[[nodiscard]] Waypoint values_of(const ipc::RingItem& item) noexcept;
/// The condition of a finish.
[[nodiscard]] Condition condition_of(const ipc::RingItem& item);

[[nodiscard]] Bytes encode(const ipc::RefusalRecord& refused);
[[nodiscard]] ipc::RefusalRecord decode_refusal(std::span<const std::byte> bytes);

[[nodiscard]] Bytes encode(const ipc::SegmentCopy& segment);
[[nodiscard]] ipc::SegmentCopy decode_segment(std::span<const std::byte> bytes,
                                              std::size_t dimensions);

/// A place from which the rest of a record can be verified.
struct Restart {
  ipc::SegmentCopy before{};               ///< the segment before the first one that is verified
  ipc::Word first_item = 0;                ///< the first item that is needed
  std::optional<ipc::RunRestart> knots{};  ///< empty: the next segment is the first of its run
};
[[nodiscard]] Bytes encode(const Restart& restart);
[[nodiscard]] Restart decode_restart(std::span<const std::byte> bytes, std::size_t dimensions);

[[nodiscard]] Bytes encode(const ipc::Summary& summary);
/// The members that encode() writes; the others have their defaults.
[[nodiscard]] ipc::Summary decode_summary(std::span<const std::byte> bytes);

/// Why something is not in a file.
enum class LossCause : std::uint8_t {
  overwritten = 0,  ///< the recorder came too late to read it from shared memory
  queue = 1,        ///< the disk was too slow
  file = 2,         ///< the file could not be written
  late_commit = 3,  ///< nothing is lost, but settled segments have been changed
};
inline constexpr std::uint8_t kLossCauses = 4;
struct Loss {
  LossCause cause{};
  ipc::Word items = 0;
  ipc::Word segments = 0;
  ipc::Word refusals = 0;
  ipc::Word others = 0;  ///< events, restarts and summaries

  [[nodiscard]] ipc::Word all() const noexcept { return items + segments + refusals + others; }
  Loss& operator+=(const Loss& other) noexcept;
  /// Counts a record.
  void count(RecordKind kind) noexcept;
};
[[nodiscard]] Bytes encode(const Loss& loss);
[[nodiscard]] Loss decode_loss(std::span<const std::byte> bytes);
[[nodiscard]] std::string_view to_string(LossCause cause) noexcept;

}  // namespace splinecast::apps::record
