#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/record/format/bytes.hpp"
#include "apps/record/format/record.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/verification/run_restart.hpp"
#include "ipc/verification/settled_segments.hpp"

/// The messages of the exact channel, byte by byte as docs/file-formats.md describes them. The
/// functions `decode_…` take a message without its first byte, and throw BadMessage for one that is
/// not valid.
namespace splinecast::apps::record {

/// The kind of a message. Throws BadMessage for an unknown kind or an empty message.
[[nodiscard]] RecordKind kind_of(std::span<const std::byte> message);

struct NumberedItem {
  ipc::Word number = 0;
  bool is_old = false;  ///< it was sent before the recorder attached
  ipc::RingItem item;
};
[[nodiscard]] Bytes encode(const NumberedItem& numbered);
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
/// The left and the right end of a segment, without the rest of its message.
[[nodiscard]] std::pair<Time, Time> times_of_segment(std::span<const std::byte> bytes);

/// `spline`, `entry`, `stop`, `hold` or `slowed`.
[[nodiscard]] std::string_view to_string(SegmentKind kind) noexcept;

/// A place from which the rest of a record can be verified.
struct Restart {
  ipc::SegmentCopy before{};               ///< the segment before the first one that is verified
  ipc::Word first_item = 0;                ///< the first item that is needed
  std::optional<ipc::RunRestart> knots{};  ///< empty: the next segment is the first of its run
};
[[nodiscard]] Bytes encode(const Restart& restart);
[[nodiscard]] Restart decode_restart(std::span<const std::byte> bytes, std::size_t dimensions);

/// What a stream has published: its summary, and the segment that has not settled to its end.
struct Published {
  ipc::Summary summary{};  ///< the members that encode() writes; the others have their defaults
  std::optional<ipc::OpenSegment> open{};
};
[[nodiscard]] Bytes encode(const Published& published);
[[nodiscard]] Published decode_published(std::span<const std::byte> bytes, std::size_t dimensions);

}  // namespace splinecast::apps::record
