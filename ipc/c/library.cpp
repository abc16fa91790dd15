#include <string>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/guard.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/streams.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

extern "C" {

const char* splinecast_version(void) { return SPLINECAST_VERSION; }

int64_t splinecast_now(void) { return MonotonicClock().now().count(); }

int splinecast_remove(const char* stream) {
  return guarded([&] {
    remove_stream(std::string(require_text(stream, "stream")));
    return 0;
  });
}

}  // extern "C"
