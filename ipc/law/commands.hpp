#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/laws/rate_plan.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/folder_watch.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

/// Rate commands. Each commander of a time law has a ring of its own, under the name
/// commander_stream(), whose items are its commands. The law's solver observes these rings: it
/// stores nothing in them, and only the newest command of each counts.
namespace splinecast::ipc {

/// A rate command.
struct RateCommand {
  Time time{};      ///< host time at which it was given
  double rate = 1;  ///< requested rate, at least 0; below 0: the commander requests none
  Time ramp{};      ///< length of the ramp to it
  Time dead_man{};  ///< after this time without a newer command, the rate is 0; 0: never
};

/// Values of a command as an item: rate, ramp [s], dead man [s].
inline constexpr std::size_t kCommandValues = 3;

/// The command in an item. Returns nothing if the item is not a waypoint, or if a value is NaN or
/// infinite. Clamps other values to their ranges, because any process may have stored them.
[[nodiscard]] std::optional<RateCommand> command_of(const RingItem& item) noexcept;

/// Shortest and longest ramp.
inline constexpr Time kShortestRamp{1'000'000};
inline constexpr Time kLongestRamp{3'600'000'000'000};

/// The options of a commander's ring.
[[nodiscard]] ProducerOptions command_ring_options(const RegionAccess& access, const Trust& trust);

/// Length of the ramp to rate 0 after a dead man has expired.
inline constexpr Time kDeadManRamp{500'000'000};

/// What one commander requests.
struct CommanderState {
  std::string name;
  RateCommand command;
  bool is_dead = false;  ///< its dead man has expired: it requests rate 0

  /// Whether it requests a rate.
  [[nodiscard]] bool requests() const noexcept { return command.rate >= 0; }
  /// What it asks of a law with this largest rate. Without a request that is the largest rate.
  [[nodiscard]] core::RateRequest request(double largest) const noexcept;
};

/// The least rate that commanders request, at most `largest`; 1, or `largest` if that is less, if
/// none requests one.
[[nodiscard]] double least_rate(std::span<const CommanderState> states, double largest) noexcept;

/// The commanders of one law, as the law's solver observes them. One thread uses it.
class Commanders {
 public:
  Commanders(std::string law, const Trust& trust) : law_(std::move(law)), trust_(trust) {}

  /// Looks for commanders that have come. One system call if no file of shared memory has come or
  /// gone since the last call, else it reads the folder; allocates for new ones. A ring that cannot
  /// be used is ignored, and tried again in the next call.
  void look_around();

  [[nodiscard]] bool empty() const noexcept { return rings_.empty(); }

  /// Whether a commander has given a command since the last read(). One load per commander.
  [[nodiscard]] bool calls() const noexcept;

  /// Reads the newest commands. `now` decides which dead men have expired.
  void read(Time now);

  /// When the next dead man expires; max() for never.
  [[nodiscard]] Time next_expiry() const noexcept;

  /// What each commander requested at the last read().
  [[nodiscard]] const std::vector<CommanderState>& states() const noexcept { return states_; }

  /// Sleeps until a commander gives a command that read() has not read, at most `timeout`; with
  /// several commanders at most 1 ms. May return early.
  void wait(Time timeout) const noexcept;

 private:
  struct Ring {
    Region region;
    WaypointRingReader ring;
    Word seen = 0;  ///< `written` at the last read

    Ring(Region mapped, const RingLayout& layout)
        : region(std::move(mapped)), ring(region.bytes(), layout) {}
  };
  [[nodiscard]] bool has(const std::string& name) const noexcept;
  void read_newest(Ring& ring, RateCommand& command);

  std::string law_;
  Trust trust_;
  FolderWatch folder_;
  bool tries_again_ = false;  ///< a ring could not be used
  std::vector<std::unique_ptr<Ring>> rings_;
  std::vector<CommanderState> states_;  ///< of each ring
  RingItem item_{kCommandValues};
};

}  // namespace splinecast::ipc
