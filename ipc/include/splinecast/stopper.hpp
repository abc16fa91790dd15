#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Stops a live stream from any process: a latched stop, for operators' panels and supervisors. It
/// is not a safety function: it needs the stream's solver, and does not reach the drives.
///
/// The next step of the solver begins a stop at the settled time, as Producer::replace_from()
/// without waypoints does, and then refuses waypoints, start states and replacements as `stopped`
/// until all stoppers of the stream have released it. A finish is taken, and ends the stream where
/// the stop rests. After the release a motion begins with the next waypoint. A motion that has been
/// finished before cannot be stopped any more: all of it has settled.
///
/// The request stays in force when this object or its process ends, when the solver ends, and when
/// the stream is created again, until a stopper of the same name releases it. It may be made before
/// there is a stream. A recorded stream and a time law have no stoppers: the law has commanders.
/// One thread uses a stopper.
class Stopper {
 public:
  /// Becomes the stopper of this name. It requests nothing until its first call, unless an earlier
  /// stopper of that name did. Throws BadRequest for an invalid name, StreamBusy if the stream has
  /// a living stopper of that name, BadRegion if the files of that name cannot be used or shared
  /// memory is full.
  Stopper(const std::string& stream, const std::string& stopper, const RegionAccess& access = {},
          const Trust& trust = {});
  Stopper(Stopper&&) noexcept;
  Stopper& operator=(Stopper&&) noexcept;
  /// Does not release the stream.
  ~Stopper();

  /// Requests that the stream stop, and stay. Returns the number of the request: see
  /// wait_in_force(). Does nothing if that is requested already. Does not wait for the solver.
  /// Throws BadRegion if the region of this stopper has been removed, so that no solver can find
  /// the request. Two system calls.
  std::uint64_t stop();

  /// Withdraws the request. Else as stop().
  std::uint64_t release();

  /// Whether this stopper, or an earlier one of its name, requests the stop.
  [[nodiscard]] bool is_latched() const noexcept;

  /// Waits until the stream's solver has committed a request of this number, or a later one: of a
  /// stop, the published curve stops from then on, or rests already. Returns false if it has not
  /// after `timeout`: the request remains. Looks every millisecond. True also if the stream has
  /// been finished before: its last motion is not stopped.
  [[nodiscard]] bool wait_in_force(std::uint64_t number, Time timeout);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast
