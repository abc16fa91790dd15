#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace splinecast::campaign::starts {

/// What must not happen.
enum class Breach : std::uint8_t {
  step,            ///< the controller's position changes more than its limit of velocity allows
  uncounted,       ///< a sample exceeds a limit, and no excess has been counted
  revised,         ///< a sample that was executed has been changed, and no commit was late
  other_clock,     ///< a time of another clock was accepted
  too_late,        ///< an accepted replacement was refused as too late
  accounts,        ///< items are not knots, refused, withdrawn or controls
  never_begins,    ///< a producer that follows the messages cannot begin
  never_consumed,  ///< items stay in the ring although a solver lives
  outcome,         ///< an item has no outcome, it changes after it was final, or it is not so
};
inline constexpr std::size_t kBreaches = 9;
[[nodiscard]] std::string_view to_string(Breach breach) noexcept;

/// Events that a long campaign has to provoke.
enum class Event : std::uint8_t {
  beginnings,
  created,
  created_after_rm,
  continued_in_motion,
  continued_at_rest,
  motions_replaced,
  other_clocks,
  refused_as_elsewhere,
  refused_as_past,
  refused_as_too_late,
  starts_from_old_end,
  starts_measured,
  starts_moved,
  starts_replaced,
  starts_replaced_soonest,
  late_replacements,
  empty_streams,
  brief_streams,
  kills,
  finishes,
  solver_restarts,
  solver_pauses,
  excesses_counted,
  samples,
  samples_of_other_boards,
  outcomes,
  items_entered,
  items_passed_over,
  items_withdrawn,
  items_refused,
  items_forgotten,
};
inline constexpr std::size_t kEvents = 31;
[[nodiscard]] std::string_view to_string(Event event) noexcept;

/// Counters of a campaign.
struct Facts {
  std::array<std::uint64_t, kBreaches> breaches{};
  std::array<std::uint64_t, kEvents> events{};
  double largest_velocity = 0;      ///< of streams without a counted excess; limit 3
  double largest_acceleration = 0;  ///< the same; limit 15

  void count(Event event) noexcept { ++events[static_cast<std::size_t>(event)]; }
  /// Counts a violation, and writes the first ones to standard error.
  void breach(Breach breach, std::uint64_t seed, const std::string& what);
};

}  // namespace splinecast::campaign::starts
