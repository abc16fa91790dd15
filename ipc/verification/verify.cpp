#include "ipc/verification/verify.hpp"

#include "ipc/verification/stream_replay.hpp"

namespace splinecast::ipc {

Verification verify(const StreamRecord& record) { return StreamReplay(record).run(); }

}  // namespace splinecast::ipc
