#include "splinecast/stopper.hpp"

#include <string>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/handles.hpp"
#include "ipc/arguments/options.hpp"
#include "ipc/arguments/structs.hpp"
#include "splinecast.h"

using namespace splinecast;
using namespace splinecast::ipc;

struct splinecast_stopper {
  Mark<0x5350'4c53'544f'5007> mark;
  Stopper stopper;
  uint64_t number = 0;  ///< of the last request

  splinecast_stopper(const std::string& stream, const std::string& name, const RegionAccess& access,
                     const Trust& trust)
      : stopper(stream, name, access, trust) {}
};

namespace {

/// Runs the body of a function with the stopper of a handle; returns its result.
template <typename Body>
int with_stopper(splinecast_stopper* stopper, const Body& body) noexcept {
  return guarded([&] { return body(require_handle(stopper, "stopper")); });
}

}  // namespace

extern "C" {

int splinecast_stopper_create(const char* stream, const char* stopper,
                              const splinecast_stopper_options* options, splinecast_stopper** out) {
  return create_handle(out, [&] {
    const auto all = read_optional(options, SPLINECAST_STOPPER_OPTIONS_INIT, "options");
    if (all.reserved != 0) refuse("options->reserved", "is not 0");
    return new splinecast_stopper(
        std::string(require_text(stream, "stream")), std::string(require_text(stopper, "stopper")),
        access_of(all.mode, all.group), trust_of(all.owner, "options->owner"));
  });
}

int splinecast_stopper_destroy(splinecast_stopper* stopper) {
  return destroy_handle(stopper, "stopper");
}

int splinecast_stopper_stop(splinecast_stopper* stopper) {
  return with_stopper(stopper, [](auto& own) { return own.number = own.stopper.stop(), 0; });
}

int splinecast_stopper_release(splinecast_stopper* stopper) {
  return with_stopper(stopper, [](auto& own) { return own.number = own.stopper.release(), 0; });
}

int splinecast_stopper_is_latched(splinecast_stopper* stopper) {
  return with_stopper(stopper, [](auto& own) { return own.stopper.is_latched() ? 1 : 0; });
}

int splinecast_stopper_number(splinecast_stopper* stopper, uint64_t* number) {
  return with_stopper(stopper, [&](auto& own) {
    *require_pointer(number, "number") = own.number;
    return 0;
  });
}

int splinecast_stopper_wait_in_force(splinecast_stopper* stopper, uint64_t number,
                                     int64_t timeout) {
  return with_stopper(stopper, [&](auto& own) {
    return own.stopper.wait_in_force(number, timeout_of(timeout)) ? 1 : 0;
  });
}

}  // extern "C"
