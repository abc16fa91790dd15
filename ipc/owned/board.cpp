#include "ipc/owned/board.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/futex.hpp"
#include "ipc/memory/system_failure.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/old_end.hpp"
#include "ipc/owned/old_motion.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// Gives a complete board the name of another one, atomically: a producer that looks for the end of
/// the old curve finds one of the two at any time. The caller holds the stream's lock.
void take_place_of(const std::string& stream, const Region& board) {
  const std::string path = region_path(stream, RegionKind::spline);
  const std::string next = path + ".new";
  const std::string self = "/proc/self/fd/" + std::to_string(board.descriptor());
  unlink(next.c_str());  // of a solver that was killed here
  const bool is_linked =
      linkat(AT_FDCWD, self.c_str(), AT_FDCWD, next.c_str(), AT_SYMLINK_FOLLOW) == 0;
  if (is_linked && rename(next.c_str(), path.c_str()) == 0) return;
  const int error = errno;
  unlink(next.c_str());
  throw_failure("cannot link the region to " + path, error);
}

/// Makes a board that has no name yet.
OwnedBoard make_board(const RegionHeader& ring_header, const SolverOptions& options,
                      const CurveEnd& old = {}) {
  RegionHeader header = ring_header;
  header.kind = static_cast<std::uint64_t>(RegionKind::spline);
  write_options(options, header);
  const auto layout = BoardLayout::of(header.dimensions, header.capacity, header.control,
                                      smooths(header), header.is_law != 0);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  header.epoch = 0;
  Region region = Region::create(layout.bytes, options.access);
  write_header(region.bytes(), header);
  enter_owner(region.bytes(), header);
  OwnedBoard board(std::move(region), header, layout, false);
  if (!old.position.empty()) board.writer.write_old_end(old.position);
  return board;
}

OwnedBoard first_board(const std::string& stream, const RegionHeader& ring_header,
                       const SolverOptions& options) {
  OwnedBoard board = make_board(ring_header, options);
  if (!board.region.link(stream, RegionKind::spline)) {
    throw BadRegion(region_path(stream, RegionKind::spline) +
                    " was created by another process at the same time");
  }
  return board;
}

/// A board in the place of one whose motion has ended. That one is retired before it loses its
/// name: a solver killed in between leaves a retired board, which the next one replaces. The other
/// order would leave its readers on a board that no solver finds again.
OwnedBoard next_board(const std::string& stream, OwnedBoard& past, const RegionHeader& ring_header,
                      const SolverOptions& options) {
  const bool follows = may_follow(ring_header, past.header);
  const CurveEnd old = follows ? end_of_curve(past.header, past.reader) : CurveEnd{};
  OwnedBoard board = make_board(ring_header, options, old);
  past.writer.retire();
  wake_all(past.writer.revision_word());
  take_place_of(stream, board.region);
  return board;
}

}  // namespace

OwnedBoard::OwnedBoard(Region mapped, const RegionHeader& described, const BoardLayout& layout,
                       bool old)
    : region(std::move(mapped)),
      lock(region.descriptor()),
      header(described),
      taken_over(old),
      writer(region.bytes(), layout),
      reader(region.bytes(), layout) {}

std::variant<OwnedBoard, Occupied> own_board(const std::string& stream,
                                             const RegionHeader& ring_header,
                                             const SolverOptions& options, const Clock& clock) {
  if (!region_exists(stream, RegionKind::spline)) return first_board(stream, ring_header, options);
  auto [region, header, layout] = open_board(stream, true, options.trust);
  OwnedBoard board(std::move(region), header, layout, true);
  if (header.stream_id != ring_header.stream_id || board.reader.retired()) {
    // Readers follow the old curve to its end: they must not find another one during the motion.
    const Time end = end_of_motion(header, board.reader, options.trust);
    const Time now = clock.now();
    require_near_end(stream, end, now);
    if (now < end) return Occupied{end};
    return next_board(stream, board, ring_header, options);
  }
  require_same_stream(ring_header, header);
  require_same_options(stream, header, options);
  enter_owner(board.region.bytes(), header);
  board.writer.store_sleeping(false);
  return board;
}

}  // namespace splinecast::ipc
