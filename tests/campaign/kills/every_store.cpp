#include <fmt/format.h>

#include <array>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/kills/attacked_stream.hpp"

namespace splinecast::campaign {
namespace {

/// Number of waypoints of a recorded stream: a long one, and one that ends soon.
constexpr ipc::Word kLongLife = 1400;
constexpr ipc::Word kShortLife = 12;
/// Two steps of one kind may do different numbers of stores. After this many steps that end before
/// store n, the sweep concludes that no step of this kind has a store n.
constexpr int kSurvivals = 8;

std::string_view to_string(Step step) {
  switch (step) {
    case Step::make_ring:
      return "creating or continuing a ring";
    case Step::append:
      return "an append";
    case Step::replace:
      return "a replacement";
    case Step::finish:
      return "a finish";
    case Step::make_board:
      return "creating or taking over a board";
    case Step::make_board_again:
      return "replacing a board";
    case Step::publish:
      return "the publication of a waypoint";
    case Step::publish_replacement:
      return "the publication of a replacement";
    case Step::publish_finish:
      return "the publication of the end";
    case Step::sleep:
      return "a solver's sleep";
    case Step::remove:
      return "rm";
    case Step::none:
      break;
  }
  return "";
}

class Sweep {
 public:
  explicit Sweep(Plan plan) : stream_(std::move(plan)) {}

  /// Kills before each store of this step in turn. Returns the number of stores.
  std::uint64_t every_store_of(Step step) {
    for (std::uint64_t store = 1;; ++store) {
      int survived = 0;
      while (survived < kSurvivals && !dies_in(step, store)) ++survived;
      if (survived == kSurvivals) return store - 1;
    }
  }

  Findings finish() { return stream_.finish(); }

 private:
  /// Waits until all processes run, arms the step, and returns whether a process died in it.
  bool dies_in(Step step, std::uint64_t store) {
    tick_until([this] { return stream_.is_calm(); });
    if (step == Step::make_ring) stream_.kill(Role::producer);
    if (step == Step::make_board) stream_.kill(Role::solver);
    if (step == Step::remove) stream_.kill_remover_at_end(kPatience);
    const std::uint64_t kills = stream_.findings().all_kills() + (step == Step::remove ? 1 : 0);
    Journal& journal = stream_.journal();
    journal.store = store;
    journal.armed = step;
    tick_until(
        [&] { return journal.armed == Step::none || stream_.findings().all_kills() > kills; });
    const bool died = journal.armed != Step::none;
    journal.armed = Step::none;
    return died;
  }

  template <typename Condition>
  void tick_until(const Condition& condition) {
    const Time end = deadline(clock_, 2 * kPatience);
    while (!condition()) {
      if (clock_.now() > end || !apps::sleep_until(clock_.now() + kLook)) {
        throw apps::Failure("'" + stream_.plan().stream + "' does not reach the step");
      }
      stream_.tick();
    }
  }

  MonotonicClock clock_;
  AttackedStream stream_;
};

}  // namespace

Result run_every_store(const CampaignOptions& options) {
  if (!has_hooks()) throw apps::InputError("--every-store needs a build with SPLINECAST_HOOKS");
  const MonotonicClock clock;
  const Time begin = clock.now();
  Findings findings;
  nlohmann::json measured = nlohmann::json::object();
  const auto sweep = [&](const char* kind, Plan plan, std::initializer_list<Step> steps) {
    plan.readers = 1;
    Sweep one(std::move(plan));
    for (const Step step : steps) {
      measured[fmt::format("stores of {} ({})", to_string(step), kind)] = one.every_store_of(step);
    }
    findings.add(one.finish());
  };
  sweep("recorded", recorded_plan(campaign_stream("long"), kLongLife),
        {Step::make_ring, Step::append, Step::make_board, Step::publish, Step::sleep});
  sweep("recreated", recorded_plan(campaign_stream("short"), kShortLife),
        {Step::make_ring, Step::finish, Step::make_board, Step::make_board_again,
         Step::publish_finish, Step::remove});
  sweep("live", live_plan(campaign_stream("live")),
        {Step::make_ring, Step::append, Step::replace, Step::make_board, Step::publish,
         Step::publish_replacement, Step::sleep});
  measured.update(findings.killing());
  return make_result(
      options, {1, 2, 4, 5, 8},
      "kill at every store: SIGKILL before every store of every step of producer, solver and rm",
      findings.all_kills(), "kills", findings, measured, to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
