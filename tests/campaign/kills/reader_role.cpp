#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <random>

#include "apps/process/signals.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "tests/campaign/kills/curve_check.hpp"
#include "tests/campaign/kills/ring_check.hpp"
#include "tests/campaign/kills/roles.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Time kAttachSlice = milliseconds(100);
/// Ticks from one survey of segments to the next.
constexpr std::uint64_t kSurveyEvery = 8;
/// Range of a survey of a live stream, before and after now.
constexpr Time kAround = milliseconds(100);
/// Range of a survey of a recorded stream before `settled_until`: at most kIntervalsBack intervals,
/// and at most 1/kPartOfTheBoard of the board.
constexpr std::size_t kIntervalsBack = 24;
constexpr std::size_t kPartOfTheBoard = 4;

class ReaderRole {
 public:
  ReaderRole(const Plan& plan, ReaderFacts& facts)
      : plan_(&plan),
        facts_(&facts),
        random_(static_cast<std::uint64_t>(getpid())),
        reader_(plan.stream, kAttachSlice),
        check_(plan, reader_, facts),
        ring_(plan, facts) {}

  /// Reads until the stream is retired or SIGTERM arrives.
  void run() {
    Time due = clock_.now();
    while (!apps::stop_requested()) {
      ++facts_->turns;
      if (plan_->tick > Time::zero()) {
        due = std::max(due + plan_->tick, clock_.now() - plan_->tick);
        if (!apps::sleep_until(due)) return;
      }
      const auto status = plan_->is_live() ? tick_live() : tick_recorded();
      ring_.look(random_() % ring_.capacity());
      if (status == SampleStatus::retired) return;
    }
  }

 private:
  Time up_to(Time most) {
    return Time(std::uniform_int_distribution<std::int64_t>(0, most.count())(random_));
  }

  SampleStatus tick_live() {
    const Time now = clock_.now();
    const auto status = check_.tick(now);
    check_.peek(now + up_to(kAround));
    if (facts_->turns % kSurveyEvery == 0) check_.survey(now - kAround, now + kAround);
    return status;
  }

  /// Samples close before `settled_until`, and at a random time up to the newest knot.
  SampleStatus tick_recorded() {
    const auto oldest = reader_.first_time();
    if (!oldest || !ipc::Internals::summary(reader_, summary_) || summary_.newest == 0) {
      return check_.peek(Time{});  // returns the status that names the reason
    }
    const Time first = *oldest;
    const Time back = static_cast<std::int64_t>(
                          std::min(kIntervalsBack, plan_->board_capacity / kPartOfTheBoard)) *
                      plan_->payload.interval();
    last_ = std::max({last_, first, summary_.settled_until - Time(1) - up_to(back / 8)});
    if (last_ < summary_.settled_until) (void)check_.tick(last_);
    const Time from = std::max(first, summary_.settled_until - back);
    if (facts_->turns % kSurveyEvery == 0) check_.survey(from, summary_.newest_time);
    return check_.peek(from + up_to(std::max(Time::zero(), summary_.newest_time - from)));
  }

  const Plan* plan_;
  ReaderFacts* facts_;
  MonotonicClock clock_;
  std::mt19937_64 random_;
  Reader reader_;
  CurveCheck check_;
  RingCheck ring_;
  ipc::Summary summary_;
  Time last_ = Time::min();
};

}  // namespace

void run_reader(const Plan& plan, ReaderFacts& facts) {
  while (!apps::stop_requested()) {
    ++facts.turns;
    try {
      ReaderRole(plan, facts).run();
    } catch (const NoSuchStream&) {
      continue;  // not created yet, or removed and soon recreated
    }
  }
}

}  // namespace splinecast::campaign
