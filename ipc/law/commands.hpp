#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/laws/rate_plan.hpp"
#include "ipc/law/commander_record.hpp"
#include "ipc/memory/region_watch.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/requests/regions.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

/// The commanders of a time law. Each has a region of its own, under the name commander_stream(),
/// with its latest state. The law's solver observes these regions: it stores nothing in them.
namespace splinecast::ipc {

/// What one commander requests.
struct CommanderState {
  std::string name;
  Word id = 0;  ///< of its region, not 0
  RateCommand command{};
  bool is_dead = false;     ///< its dead man has expired: it requests rate 0 until a new request
  bool is_damaged = false;  ///< its region holds no whole request any more: it requests rate 0
  bool is_alive = true;     ///< its process lived when it was last looked at
  Time damaged_since = Time::max();  ///< when its record was first found damaged

  /// Whether it requests a rate.
  [[nodiscard]] bool requests() const noexcept { return command.rate >= 0; }
  /// Whether the law must know it: it requests a rate, or may do so.
  [[nodiscard]] bool is_used() const noexcept { return requests() || is_damaged || is_alive; }
  /// What it asks of a law with this largest rate: without a request the largest rate, with a dead
  /// man that has fired rate 0.
  [[nodiscard]] core::RateRequest request(double largest, bool has_died) const noexcept;
  [[nodiscard]] core::RateRequest request(double largest) const noexcept {
    return request(largest, is_dead);
  }
};

/// The least rate that commanders request, at most `largest`; 1, or `largest` if that is less, if
/// none requests one.
[[nodiscard]] double least_rate(std::span<const CommanderState> states, double largest) noexcept;

/// The commanders of one law, as the law's solver observes them. One thread uses it.
class Commanders {
 public:
  /// `watch` knows the names of the commanders; it outlives this object, and its owner calls its
  /// poll().
  Commanders(std::string law, const Trust& trust, const RegionWatch& watch)
      : regions_(std::move(law), RegionKind::commander, trust, watch.commanders()) {}

  /// Whether a commander of any law has come or gone since the last poll(), or has not been
  /// opened yet. One load.
  [[nodiscard]] bool has_news() const noexcept { return regions_.has_untried(); }

  /// Opens the regions of commanders that have come: see RequestRegions. In one of 50 calls, and if
  /// `needs_room`, some system calls for each commander that requests nothing, to see whether its
  /// process lives.
  void poll(bool needs_room = false);

  [[nodiscard]] bool empty() const noexcept { return states_.empty(); }

  [[nodiscard]] const RequestRegions& regions() const noexcept { return regions_; }

  /// Whether a commander has come, or given a command since the last read(). One load per
  /// commander.
  [[nodiscard]] bool calls() const noexcept { return regions_.calls(); }

  /// Reads what each commander requests. `now` decides which dead men have expired. A record that
  /// is torn or not valid leaves the last good one; after kMostDamaged the commander requests rate
  /// 0, with its last ramp of a dead man. Bounded, for any content of the regions.
  void read(Time now);

  /// When the next dead man expires, or a damaged record begins to count as rate 0; max() for
  /// never.
  [[nodiscard]] Time next_expiry() const noexcept;

  /// What each commander requested at the last read().
  [[nodiscard]] const std::vector<CommanderState>& states() const noexcept { return states_; }

  /// Sleeps until a commander gives a command that read() has not read, at most `timeout`; with
  /// several commanders at most 1 ms. May return early.
  void wait(Time timeout) const noexcept;

 private:
  static constexpr Time kMostDamaged{20'000'000};

  void match_states();
  void check_processes(bool needs_room);
  static void read_newest(RequestRegions::Source& source, CommanderState& state, Time now) noexcept;

  RequestRegions regions_;
  int polls_ = 0;                       ///< calls of poll()
  std::vector<CommanderState> states_;  ///< of each region
};

}  // namespace splinecast::ipc
