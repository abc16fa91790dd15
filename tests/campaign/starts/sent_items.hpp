#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "splinecast/producer.hpp"
#include "tests/campaign/starts/facts.hpp"
#include "tests/campaign/starts/world.hpp"

namespace splinecast::campaign::starts {

/// The items of one stream, and what its producers say became of them: each has an outcome, a final
/// one stays, and the curve is where it says that a waypoint is in force.
class SentItems {
 public:
  SentItems(std::uint64_t seed, World& world, Facts& facts)
      : seed_(seed), world_(world), facts_(facts) {}

  /// A producer has been created.
  void begin(const Producer& producer);

  /// The call has been accepted. `s`: the coordinate of its last item, if that is a waypoint;
  /// `followers`: of a replacement, its waypoints.
  void note(const Producer& producer, std::optional<double> s, std::uint64_t followers = 0);

  /// Compares outcomes of the last items. `is_over`: the solver has taken all, and the finish.
  void check(Producer& producer, bool is_over);

 private:
  struct Sent {
    std::uint64_t item = 0;
    std::optional<double> s{};  ///< of a waypoint
    std::optional<ItemOutcome> was{};
  };

  void check(const Sent& sent, const ItemOutcome& found, bool is_over, bool is_kept);
  void compare(const Sent& sent, const ItemOutcome& found);

  std::uint64_t seed_;
  World& world_;
  Facts& facts_;
  std::deque<Sent> sent_;
  std::uint64_t stream_ = 0;
  std::uint64_t restarts_ = 0;  ///< of solvers, until this stream was created
};

}  // namespace splinecast::campaign::starts
