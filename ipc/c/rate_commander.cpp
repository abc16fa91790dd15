#include "splinecast/rate_commander.hpp"

#include <string>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/handles.hpp"
#include "ipc/arguments/options.hpp"
#include "ipc/arguments/structs.hpp"
#include "splinecast.h"

using namespace splinecast;
using namespace splinecast::ipc;

struct splinecast_rate_commander {
  Mark<0x5350'4c52'4154'4506> mark;
  RateCommander commander;
  uint64_t number = 0;  ///< of the last request

  splinecast_rate_commander(const std::string& law, const std::string& name,
                            const RegionAccess& access, const Trust& trust)
      : commander(law, name, access, trust) {}
};

namespace {

/// Runs the body of a function with the commander of a handle; returns 0.
template <typename Body>
int with(splinecast_rate_commander* commander, const Body& body) noexcept {
  return guarded([&] {
    body(require_handle(commander, "commander"));
    return 0;
  });
}

}  // namespace

extern "C" {

int splinecast_rate_commander_create(const char* law, const char* commander,
                                     const splinecast_rate_commander_options* options,
                                     splinecast_rate_commander** out) {
  return create_handle(out, [&] {
    const auto all = read_optional(options, SPLINECAST_RATE_COMMANDER_OPTIONS_INIT, "options");
    if (all.reserved != 0) refuse("options->reserved", "is not 0");
    return new splinecast_rate_commander(
        std::string(require_text(law, "law")), std::string(require_text(commander, "commander")),
        access_of(all.mode, all.group), trust_of(all.owner, "options->owner"));
  });
}

int splinecast_rate_commander_destroy(splinecast_rate_commander* commander) {
  return destroy_handle(commander, "commander");
}

int splinecast_rate_commander_set_rate(splinecast_rate_commander* commander, double rate,
                                       int64_t ramp) {
  return with(commander, [&](auto& own) { own.number = own.commander.set_rate(rate, Time(ramp)); });
}

int splinecast_rate_commander_hold(splinecast_rate_commander* commander, int64_t ramp) {
  return with(commander, [&](auto& own) { own.number = own.commander.hold(Time(ramp)); });
}

int splinecast_rate_commander_release(splinecast_rate_commander* commander, int64_t ramp) {
  return with(commander, [&](auto& own) { own.number = own.commander.release(Time(ramp)); });
}

int splinecast_rate_commander_set_dead_man(splinecast_rate_commander* commander, int64_t timeout,
                                           int64_t ramp) {
  return with(commander, [&](auto& own) { own.commander.set_dead_man(Time(timeout), Time(ramp)); });
}

int splinecast_rate_commander_renew(splinecast_rate_commander* commander) {
  return guarded([&] { return require_handle(commander, "commander").commander.renew() ? 0 : 1; });
}

int splinecast_rate_commander_number(splinecast_rate_commander* commander, uint64_t* number) {
  return with(commander, [&](auto& own) { *require_pointer(number, "number") = own.number; });
}

int splinecast_rate_commander_wait_in_force(splinecast_rate_commander* commander, uint64_t number,
                                            int64_t timeout) {
  return guarded([&] {
    auto& own = require_handle(commander, "commander").commander;
    return own.wait_in_force(number, timeout_of(timeout)) ? 1 : 0;
  });
}

}  // extern "C"
