#include "apps/streams/own_board.hpp"

#include <fmt/format.h>

#include "apps/process/exit_codes.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

ipc::CheckedRegion<ipc::BoardLayout> open_own_board(const std::string& stream,
                                                    std::uint64_t stream_id, const Trust& trust) {
  auto board = ipc::open_board(stream, false, trust);
  if (board.header.stream_id != stream_id) {
    throw Failure(fmt::format("stream '{}' was recreated by another producer", stream));
  }
  return board;
}

}  // namespace

OwnBoard::OwnBoard(const std::string& stream, std::uint64_t stream_id, const Trust& trust)
    : board_(open_own_board(stream, stream_id, trust)),
      reader_(board_.region.bytes(), board_.layout) {}

void remove_board_without_ring(const std::string& stream, const Trust& trust) {
  if (ipc::region_exists(stream, ipc::RegionKind::waypoints)) return;
  try {
    remove_stream(stream, trust);
  } catch (const StreamError&) {
    return;  // only the earlier error is reported
  }
}

ipc::Summary OwnBoard::summary() const {
  constexpr int kTries = 64;
  ipc::Summary summary;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (reader_.copy_newest_summary(summary) || reader_.look().revision == 0) return summary;
  }
  throw Failure("the summary of the newest revision cannot be read from the board");
}

}  // namespace splinecast::apps
