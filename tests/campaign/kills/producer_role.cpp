#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/producer.hpp"
#include "tests/campaign/kills/roles.hpp"

namespace splinecast::campaign {
namespace {

using ipc::ItemKind;
using std::chrono::milliseconds;

constexpr Time kRoomSlice = milliseconds(50);
/// How far ahead live waypoints are sent.
constexpr Time kLead = milliseconds(60);
/// Least distance of a live waypoint from the settled curve, which leaves time for an entry.
constexpr Time kLeastLead = milliseconds(20);
constexpr int kReplacementsOneIn = 300;  // ticks
constexpr int kMostReplaced = 10;        // waypoints

class ProducerRole {
 public:
  ProducerRole(const Plan& plan, Journal& journal)
      : plan_(&plan), journal_(&journal), random_(static_cast<std::uint64_t>(getpid())) {
    WithinStep making(journal, Step::make_ring);
    producer_.emplace(plan.stream, plan.producer_options());
    making.survived();
  }

  void run_recorded() {
    Time due = clock_.now();
    for (ipc::Word n = producer_->appended(); n < plan_->life; ++n) {
      if (!pause(due) || !send_recorded(n)) return;
    }
    finish();
  }

  void run_live() {
    next_ = plan_->payload.number_from(producer_->continues() ? producer_->last_time() + Time(1)
                                                              : clock_.now());
    for (Time due = clock_.now(); pause(due);) tick();
    finish();
  }

 private:
  /// Waits for the time of the next append. Returns false after SIGTERM.
  bool pause(Time& due) {
    if (plan_->pace == Time::zero()) return !apps::stop_requested();
    due = std::max(due + plan_->pace, clock_.now() - plan_->pace);
    return apps::sleep_until(due);
  }

  AppendStatus append(ipc::Word number) {
    const Payload::Row row = plan_->payload.position_of(number);
    WithinStep appending(*journal_, Step::append);
    journal_->last_sent = ItemKind::waypoint;
    const AppendStatus status =
        producer_->append({.time = plan_->payload.time_of(number), .position = row});
    if (status == AppendStatus::accepted) {
      appending.survived();
      journal_->accepted = producer_->appended();
    }
    return status;
  }

  /// Sends one waypoint, waiting for room. Returns false after SIGTERM.
  bool send_recorded(ipc::Word number) {
    for (;;) {
      const AppendStatus status = append(number);
      if (status == AppendStatus::accepted) return true;
      if (status != AppendStatus::full) {
        throw apps::Failure("waypoint " + std::to_string(number) + " of '" + plan_->stream +
                            "' was refused: " + std::string(to_string(status)));
      }
      (void)producer_->wait_for_room(kRoomSlice);
      if (apps::stop_requested()) return false;
    }
  }

  void tick() {
    const Time now = clock_.now();
    const Step armed = journal_->armed;
    const bool must_replace = armed == Step::replace || armed == Step::publish_replacement;
    if (must_replace || random_() % kReplacementsOneIn == 0) return replace(now);
    skip_past(now);
    // A refused waypoint keeps its number: the next one has the next position of the motion.
    while (plan_->payload.time_of(next_) - kLead <= now) (void)append(next_++);
  }

  void skip_past(Time now) {
    const Time earliest = std::max(now, producer_->earliest()) + kLeastLead;
    next_ = std::max(next_, plan_->payload.number_from(earliest));
  }

  /// Replaces the future by 0 to kMostReplaced waypoints of the same payload.
  void replace(Time now) {
    const Time t = std::max(now, producer_->earliest()) + kLeastLead;
    const ipc::Word first = plan_->payload.number_from(t + kLeastLead);
    const auto count = static_cast<std::size_t>(random_() % (kMostReplaced + 1));
    std::vector<Payload::Row> rows(count);
    std::vector<Waypoint> waypoints(count);
    for (std::size_t i = 0; i < count; ++i) {
      rows[i] = plan_->payload.position_of(first + i);
      waypoints[i] = {.time = plan_->payload.time_of(first + i), .position = rows[i]};
    }
    WithinStep replacing(*journal_, Step::replace);
    journal_->last_sent = ItemKind::replace;
    if (producer_->replace_from(t, waypoints) != AppendStatus::accepted) return;
    replacing.survived();
    journal_->accepted = producer_->appended();
    next_ = first + count;
  }

  void finish() {
    for (;;) {
      WithinStep finishing(*journal_, Step::finish);
      journal_->last_sent = ItemKind::finish;
      const AppendStatus status = producer_->finish(end_condition());
      if (status == AppendStatus::accepted) {
        finishing.survived();
        break;
      }
      if (status != AppendStatus::full) throw apps::Failure("'" + plan_->stream + "' cannot end");
      (void)producer_->wait_for_room(kRoomSlice);
    }
    journal_->accepted = producer_->appended();
  }

  const Plan* plan_;
  Journal* journal_;
  MonotonicClock clock_;
  std::mt19937_64 random_;
  std::optional<Producer> producer_;
  ipc::Word next_ = 0;
};

}  // namespace

void run_producer(const Plan& plan, Journal& journal) {
  ProducerRole role(plan, journal);
  if (plan.is_live()) {
    role.run_live();
  } else {
    role.run_recorded();
  }
}

}  // namespace splinecast::campaign
