#include "support/own_board.hpp"

#include <fmt/format.h>

#include "support/exit_codes.hpp"

namespace splinecast::apps {
namespace {

ipc::RegionHeader checked_header(const ipc::Region& region, const std::string& stream,
                                 std::uint64_t stream_id) {
  const ipc::RegionHeader header = ipc::copy_header(region.bytes());
  if (header.stream_id != stream_id) {
    throw Failure(fmt::format("stream '{}' has been made anew by another producer", stream));
  }
  return header;
}

}  // namespace

OwnBoard::OwnBoard(const std::string& stream, std::uint64_t stream_id, const ipc::Trust& trust)
    : region_(ipc::Region::open(stream, ipc::RegionKind::spline, false, trust)),
      header_(checked_header(region_, stream, stream_id)),
      reader_(region_.bytes(), ipc::checked_board_layout(header_, region_.bytes().size())) {}

}  // namespace splinecast::apps
