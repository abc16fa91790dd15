#include "ipc/verification/verify.hpp"

#include <set>
#include <utility>

#include "ipc/verification/stream_replay.hpp"

namespace splinecast::ipc {
namespace {

/// Each late cut that has to be found costs one more replay. A record with more of them is not
/// verified.
constexpr std::size_t kMostLateCuts = 1000;

}  // namespace

Verification verify(const StreamRecord& record) {
  std::set<std::size_t> late_cuts;
  StreamReplay replay(record);
  Verification found = replay.run();
  auto open = replay.open_cut();
  while (found.first && open && late_cuts.size() < kMostLateCuts) {
    late_cuts.insert(*open);
    StreamReplay next(record, late_cuts);
    Verification again = next.run();
    if (again.first && again.equal <= found.equal) return found;
    found = std::move(again);
    open = next.open_cut();
  }
  return found;
}

}  // namespace splinecast::ipc
