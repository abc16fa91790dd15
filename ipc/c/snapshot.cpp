#include <string>

#include "ipc/arguments/segments.hpp"
#include "ipc/c/roles.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

/// Runs the body of a function with the snapshot of a handle.
template <typename Body>
int with(splinecast_snapshot* snapshot, const Body& body) noexcept {
  return guarded([&] { return body(require_handle(snapshot, "snapshot").snapshot); });
}

}  // namespace

extern "C" {

int splinecast_snapshot_create(size_t dimensions, splinecast_snapshot** out) {
  return create_handle(out, [&] {
    if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
      refuse("dimensions", "is " + std::to_string(dimensions) + ", not 1 to 64");
    }
    return new splinecast_snapshot(dimensions);
  });
}

int splinecast_snapshot_destroy(splinecast_snapshot* snapshot) {
  return destroy_handle(snapshot, "snapshot");
}

int splinecast_reader_snapshot(splinecast_reader* reader, int64_t from, int64_t to,
                               splinecast_snapshot* out) {
  return guarded([&] {
    splinecast_reader& own = require_handle(reader, "reader");
    Snapshot& snapshot = require_handle(out, "out").snapshot;
    if (snapshot.dimensions() != own.reader.dimensions()) {
      refuse("out", "has " + std::to_string(snapshot.dimensions()) + " dimensions, not " +
                        std::to_string(own.reader.dimensions()));
    }
    return static_cast<int>(own.reader.snapshot(Time(from), Time(to), snapshot));
  });
}

int splinecast_snapshot_segments(splinecast_snapshot* snapshot, size_t* segments) {
  return with(snapshot, [&](const Snapshot& own) {
    *require_pointer(segments, "segments") = own.size();
    return 0;
  });
}

int splinecast_snapshot_revision(splinecast_snapshot* snapshot, uint64_t* revision) {
  return with(snapshot, [&](const Snapshot& own) {
    *require_pointer(revision, "revision") = own.revision();
    return 0;
  });
}

int splinecast_snapshot_settled_until(splinecast_snapshot* snapshot, int64_t* time) {
  return with(snapshot, [&](const Snapshot& own) {
    *require_pointer(time, "time") = own.settled_until().count();
    return 0;
  });
}

int splinecast_snapshot_segment(splinecast_snapshot* snapshot, size_t i, splinecast_segment* out) {
  return with(snapshot, [&](const Snapshot& own) {
    require_size(out, sizeof(splinecast_segment), "out");
    require_segment(i, own.size());
    put_segment(own[i], own.dimensions(), out);
    return 0;
  });
}

}  // extern "C"
