// A panel that stops a machine and releases it. It may be any process of this host.
//
//   11_stop [STREAM [SECONDS]]      default: arm 1
//
// Needs a stream in motion and its solver. A second run with the same name continues the request
// that an earlier one has left, as after a crash.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <splinecast/errors.hpp>
#include <splinecast/stopper.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

int run(const std::string& stream, Time length) {
  Stopper panel(stream, "panel");
  const auto request = panel.stop();
  if (!panel.wait_in_force(request, 1s)) std::puts("not in force: does the solver run?");
  std::printf("'%s' is stopped\n", stream.c_str());
  std::this_thread::sleep_for(length);
  // Only this call releases the machine: neither the end of this program nor its death does.
  const bool is_released = panel.wait_in_force(panel.release(), 1s);
  std::printf("'%s' is %s\n", stream.c_str(), is_released ? "released" : "to be released");
  return is_released ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const double seconds = argc > 2 ? std::strtod(argv[2], nullptr) : 1;
    return run(argc > 1 ? argv[1] : "arm", from_seconds(seconds));
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
