#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Requests the rate of a time law, for operators' panels, feed hold and emergency stop. A law maps
/// host time to the stream time of all streams that follow it; its rate is stream time per host
/// time. A law may have up to 16 commanders, each with a name; the law has the least of the
/// rates that they request. Its solver (`splinecast solve`) creates the law when the first
/// commander appears.
///
/// When a commander ends, its last request remains in force until a commander of the same name
/// makes another one, or until its dead man expires. One thread uses a commander.
class RateCommander {
 public:
  /// Becomes the commander `commander` of the law. It requests nothing until its first call, unless
  /// an earlier commander of that name did. Throws BadRequest for an invalid name, StreamBusy if
  /// the law has a living commander of that name, OutOfResources if it has 16 others, as many as a
  /// law can have, BadRegion if the files of that name cannot be used or shared memory is full.
  RateCommander(const std::string& law, const std::string& commander,
                const RegionAccess& access = {}, const Trust& trust = {});
  RateCommander(RateCommander&&) noexcept;
  RateCommander& operator=(RateCommander&&) noexcept;
  ~RateCommander();

  /// Requests a rate of at least 0, reached by a ramp of this length, 1 ms to 1 h. The ramp begins
  /// about one freeze-ahead of the law's solver later; a rise that it interrupts is first
  /// flattened, within a quarter of it. The rate never exceeds what this commander alone would make
  /// it, regardless of the others. Throws BadRequest for values out of range, and for a rate above
  /// the law's largest; while no solver has begun the law, that counts as the largest. Throws
  /// BadRegion if the region of this commander has been removed, so that no solver can find the
  /// request. Returns the number of the request: see wait_in_force(). Does not wait for the solver.
  /// Three system calls; one more until a solver has begun the law.
  std::uint64_t set_rate(double rate, Time ramp);

  /// Requests rate 0: a feed hold.
  std::uint64_t hold(Time ramp) { return set_rate(0, ramp); }

  /// Withdraws the request. If it was the least one, the rate rises to that of the next commander,
  /// or to 1 if there is none, by a ramp of this length.
  std::uint64_t release(Time ramp);

  /// Waits until the law's solver has committed a request of this number, or a later one: from then
  /// on it is in force, and its ramp begins within the solver's freeze-ahead. Returns false if it
  /// has not after `timeout`: the request remains. Looks every millisecond.
  [[nodiscard]] bool wait_in_force(std::uint64_t number, Time timeout);

  /// From the next request on, the law holds if this commander does not renew its request within
  /// `timeout`, 1 ms to 1 h; 0: never. That hold has a ramp of this length, 1 ms to 1 h, and lasts
  /// until the next request: renew() does not end it.
  void set_dead_man(Time timeout, Time ramp = std::chrono::milliseconds(500));

  /// Renews the last request, for set_dead_man(): that of an earlier commander of this name, if
  /// this one has made none. Without one, or if the earlier one died while it made it, does
  /// nothing. Returns false, and does nothing, if the dead man of that request has fired: make
  /// another request. Three system calls.
  bool renew();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast
