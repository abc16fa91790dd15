#include "support/own_board.hpp"

#include <fmt/format.h>

#include "support/exit_codes.hpp"

namespace splinecast::apps {
namespace {

ipc::CheckedRegion<ipc::BoardLayout> open_own_board(const std::string& stream,
                                                    std::uint64_t stream_id,
                                                    const ipc::Trust& trust) {
  auto board = ipc::open_board(stream, false, trust);
  if (board.header.stream_id != stream_id) {
    throw Failure(fmt::format("stream '{}' has been made anew by another producer", stream));
  }
  return board;
}

}  // namespace

OwnBoard::OwnBoard(const std::string& stream, std::uint64_t stream_id, const ipc::Trust& trust)
    : board_(open_own_board(stream, stream_id, trust)),
      reader_(board_.region.bytes(), board_.layout) {}

}  // namespace splinecast::apps
