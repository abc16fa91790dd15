#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ipc/layout/request_control.hpp"
#include "ipc/memory/region_watch.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/requests/faults.hpp"
#include "ipc/requests/regions.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

/// The stoppers of a stream. Each has a region of its own, under the name stopper_stream(), with
/// its latest request: that the stream stop and stay, or nothing any more. The stream's solver
/// observes these regions: it stores nothing in them.
namespace splinecast::ipc {

/// What a stopper requests.
struct StopRequest {
  Word number = 0;  ///< of the request; 0: none yet
  Time time{};      ///< host time at which it was made
  bool is_latched = false;
};

/// The words of a request, and the request in words. Nothing if a value is not one that a stopper
/// writes: any process that may write the region can have stored it.
[[nodiscard]] std::array<Word, kStopperRecordWords> words_of(const StopRequest& request) noexcept;
[[nodiscard]] std::optional<StopRequest> stop_request_of(
    const std::array<Word, kStopperRecordWords>& words) noexcept;

/// A stopper as the solver knows it.
struct StopperState {
  std::string name;
  Word id = 0;         ///< of its region; 0: the region could not be opened for lack of resources
  Word number = 0;     ///< of its last whole request
  bool holds = false;  ///< it holds the stream
  bool is_damaged = false;  ///< its region holds no whole request: it counts as holding the stream
};

/// The requests of a stream's stoppers, as a step of its solver reads them.
class StopRequests {
 public:
  StopRequests() = default;
  StopRequests(const StopRequests&) = delete;
  StopRequests& operator=(const StopRequests&) = delete;
  virtual ~StopRequests() = default;

  /// What each stopper requests now. Valid until the next call. Bounded; makes no system call and
  /// does not allocate.
  virtual std::span<const StopperState> read() noexcept = 0;
};

/// The stoppers of one stream, by their regions. One thread uses it.
class Stoppers : public StopRequests {
 public:
  /// `watch` knows their names; it outlives this object, and its owner calls its poll().
  Stoppers(std::string stream, const Trust& trust, const RegionWatch& watch)
      : regions_(std::move(stream), RegionKind::stopper, trust, watch.stoppers()) {}

  /// Opens the regions that have come: see RequestRegions. One load while nothing has come or gone;
  /// looks every 20 ms for retired ones, and tries again those that could not be used. A stopper
  /// whose region cannot be opened for lack of memory or descriptors holds the stream until it can
  /// be read. `now` is of the host's clock.
  void poll(Time now);

  /// A request that is torn or not valid counts as one to stop: a writer that is stopped while it
  /// stores one changes from or to that.
  std::span<const StopperState> read() noexcept override;

  /// What a person must know of them: see RequestFaults::take().
  void take_faults(std::vector<std::string>& out) { faults_.take(out); }

  /// Whether the stream has a stopper, also one that requests nothing.
  [[nodiscard]] bool is_used() const noexcept { return !states_.empty(); }

  [[nodiscard]] const RequestRegions& regions() const noexcept { return regions_; }

 private:
  void note_faults();

  RequestRegions regions_;
  std::vector<StopperState> states_;  ///< of each region, then of those that could not be opened
  RequestFaults faults_;
  bool was_held_ = false;  ///< a stopper has held the stream
  Time next_poll_ = Time::min();
};

}  // namespace splinecast::ipc
