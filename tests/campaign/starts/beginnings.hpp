#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "splinecast/producer.hpp"
#include "tests/campaign/starts/facts.hpp"
#include "tests/campaign/starts/sent_items.hpp"
#include "tests/campaign/starts/world.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::starts {

/// A motion of one coordinate within half of its limits, from rest.
struct Path {
  double from = 0;
  double amplitude = 0;
  double frequency = 1;  ///< rad/s
  Time begin{};

  [[nodiscard]] double at(Time t) const noexcept;
};

/// Producers of one stream name, one after the other, which begin in every way and are finished,
/// killed or removed at any time.
class Beginnings {
 public:
  Beginnings(std::uint64_t seed, Random& random, Facts& facts);

  /// Plays this number of beginnings.
  void play(std::size_t count);

 private:
  void begin();
  void create();
  void send_other_clock();
  [[nodiscard]] bool send_first();
  [[nodiscard]] AppendStatus try_first(Time t);
  [[nodiscard]] AppendStatus replace(Time t, bool is_soonest);
  void choose_start(Time t);
  void note(AppendStatus status);
  void move_on();
  AppendStatus append(Time t);
  void send_waypoints(Time until);
  void end();
  void kill();
  void finish();
  void check_accounts();
  [[nodiscard]] Path new_path(Time begin);

  std::uint64_t seed_;
  Random& random_;
  Facts& facts_;
  World world_;
  SentItems items_;
  std::optional<Producer> producer_;
  Path path_;
  Time interval_{};
  Time lead_{};
  Time next_{};  ///< time of the next waypoint
  bool is_removed_ = true;
};

}  // namespace splinecast::campaign::starts
