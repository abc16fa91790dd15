#include "tests/campaign/motions/live_row.hpp"

#include <algorithm>
#include <boost/interprocess/anonymous_shared_memory.hpp>
#include <chrono>
#include <cmath>
#include <memory>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/patience.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Time kTick = milliseconds(1);
using testing::kPatience;
constexpr double kSettling = 2;                   // s: errors are measured from here on
constexpr double kEnd = LiveRow::kSeconds - 0.1;  // s: the stream starves after it

Time to_time(double seconds) { return Time(std::llround(seconds * 1e9)); }

void raise(std::atomic<std::int64_t>& most, Time late) {
  if (late.count() > most) most = late.count();
}

bool is_in(const std::vector<std::pair<double, double>>& intervals, double t) {
  return std::ranges::any_of(intervals,
                             [&](const auto& i) { return t >= i.first && t < i.second; });
}

/// Statistics of the samples of one reader; also detects steps of the position between samples.
class Samples {
 public:
  Samples(const Sines& motion, const Schedule& schedule) : motion_(motion), schedule_(schedule) {}

  void add(double t, SampleStatus status, const State& state) {
    ++samples_;
    revised_ += status == SampleStatus::revised ? 1U : 0U;
    if (!is_in(schedule_.pauses, t) && !is_in(schedule_.deaths, t)) {
      ++judged_;
      held_ += status == SampleStatus::holding ? 1U : 0U;
    }
    double error = 0;
    for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
      const double target = motion_.at(joint, t) + schedule_.offset(t);
      error = std::max(error, std::abs(state.position()[joint] - target));
      velocity_ = std::max(velocity_, std::abs(state.velocity()[joint]));
      acceleration_ = std::max(acceleration_, std::abs(state.acceleration()[joint]));
    }
    if (t >= kSettling) errors_.push_back(error);
    look_for_step(t, state);
  }

  [[nodiscard]] nlohmann::json json() {
    std::ranges::sort(errors_);
    const auto quantile = [&](double share) {
      return errors_.empty() ? 0.0
                             : errors_[static_cast<std::size_t>(
                                   share * static_cast<double>(errors_.size() - 1))];
    };
    return {
        {"velocity", velocity_},
        {"acceleration", acceleration_},
        {"p99", quantile(0.99)},
        {"largest", quantile(1)},
        {"holding", judged_ > 0 ? static_cast<double>(held_) / static_cast<double>(judged_) : 1},
        {"samples", samples_},
        {"steps", steps_},
        {"revised", revised_}};
  }

 private:
  /// Compares the change of position with the trapezoidal rule over both velocities. The tolerance
  /// is the error of this rule if the acceleration changes by 2·kMost within the interval.
  void look_for_step(double t, const State& state) {
    constexpr double kMost = 1000;  // rad/s²
    const double h = t - before_t_;
    for (std::size_t joint = 0; has_before_ && joint < Sines::kJoints; ++joint) {
      const double moved = state.position()[joint] - before_.position()[joint];
      const double mean = (state.velocity()[joint] + before_.velocity()[joint]) / 2;
      steps_ += std::abs(moved - mean * h) > kMost * h * h / 2 + 1e-6 ? 1U : 0U;
    }
    before_ = state;
    before_t_ = t;
    has_before_ = true;
  }

  const Sines& motion_;
  const Schedule& schedule_;
  std::vector<double> errors_;
  double velocity_ = 0;
  double acceleration_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t judged_ = 0;
  std::uint64_t held_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t revised_ = 0;
  bool has_before_ = false;
  double before_t_ = 0;
  State before_{Sines::kJoints};
};

}  // namespace

LiveRow::LiveRow(const Sines& motion, const Fault& fault, double limit, Time begin,
                 std::string stream)
    : motion_(motion),
      fault_(fault),
      limit_(limit),
      begin_(begin),
      stream_(std::move(stream)),
      schedule_(fault.make(motion, 1)),
      memory_(boost::interprocess::anonymous_shared_memory(sizeof(LiveFacts))),
      facts_(std::construct_at(static_cast<LiveFacts*>(memory_.get_address()))) {
  std::erase_if(schedule_.calls, [](const Call& call) { return call.at >= kSeconds; });
  start_solver();
  start_producer();
  start_reader();
}

LiveRow::~LiveRow() {
  producer_.reset();
  solver_.reset();
  reader_.reset();
  observer_.reset();
  try {
    remove_stream(stream_);
  } catch (const std::exception& error) {
    apps::say(error.what());
  }
}

Time LiveRow::stream_time(double t) const { return begin_ + to_time(t); }

void LiveRow::start_solver() {
  solver_.emplace([this] {
    run_solver();
    return nullptr;
  });
}
void LiveRow::start_producer() {
  producer_.emplace([this] {
    run_producer();
    return nullptr;
  });
}
void LiveRow::start_reader() {
  reader_.emplace([this] { return run_reader(); });
}

void LiveRow::run_solver() const {
  const MonotonicClock clock;
  SolverOptions options{.stop_time = core::WindowOptions{}.stop_length};
  if (limit_ > 0) options.limits = MotionLimits{.acceleration = {limit_}};
  Solver solver(stream_, options);
  while (!apps::stop_requested()) {
    if (!solver.attached() && !solver.attach()) {
      solver.wait(milliseconds(5));
      continue;
    }
    const Time due = solver.due();
    if (due != Time::max() && due > begin_) raise(facts_->solver_late, clock.now() - due);
    const auto result = solver.step(clock);
    if (result.consumed == 0 && !result.missed) solver.wait(milliseconds(50));
  }
}

void LiveRow::run_producer() const {
  const MonotonicClock clock;
  Producer producer(stream_, {.dimensions = Sines::kJoints, .capacity = 4096});
  if (!producer.wait_for_solver(kPatience)) throw apps::Failure("no solver for '" + stream_ + "'");
  const Time last = producer.continues() ? producer.last_time() : Time::min();
  while (facts_->calls < schedule_.calls.size()) {
    const Call& call = schedule_.calls[facts_->calls];
    if (!apps::sleep_until(stream_time(call.at))) return;
    if (call.at > 0) raise(facts_->producer_late, clock.now() - stream_time(call.at));
    // Skip a call that the previous producer sent but did not count before it died.
    if (call.replaces_from || stream_time(call.times.back()) > last) send(producer, call);
    ++facts_->calls;
  }
}

void LiveRow::send(Producer& producer, const Call& call) const {
  std::vector<std::vector<double>> positions = call.positions;
  std::vector<Waypoint> waypoints;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (double& x : positions[i]) {
      if (fault_.quantum > 0) x = std::round(x / fault_.quantum) * fault_.quantum;
    }
    waypoints.push_back({.time = stream_time(call.times[i]), .position = positions[i]});
  }
  if (call.replaces_from) {
    count(producer.replace_from(stream_time(*call.replaces_from), waypoints));
    return;
  }
  for (const Waypoint& waypoint : waypoints) count(producer.append(waypoint));
}

void LiveRow::count(AppendStatus status) const {
  if (status == AppendStatus::accepted) return;
  const bool is_late = status == AppendStatus::past || status == AppendStatus::too_late;
  ++(is_late ? facts_->late_calls : facts_->refused_calls);
}

nlohmann::json LiveRow::run_reader() const {
  const MonotonicClock clock;
  Reader reader(stream_, kPatience);
  State state(Sines::kJoints);
  Samples samples(motion_, schedule_);
  for (Time due = begin_; due < stream_time(kEnd); due = std::max(due + kTick, clock.now())) {
    if (!apps::sleep_until(due)) break;
    const Time now = clock.now();
    const auto status = reader.sample(now, state);
    if (has_values(status)) samples.add(to_seconds(now - begin_), status, state);
  }
  return samples.json();
}

void LiveRow::tick(Time now) {
  const double t = to_seconds(now - begin_);
  const auto keep = [&](std::optional<apps::Child>& child, const auto& deaths, auto start) {
    const bool is_dead = is_in(deaths, t);
    if (is_dead && child) {
      child.reset();
      ++kills_;
    }
    if (!is_dead && !child) start();
  };
  if (!schedule_.deaths.empty()) {
    keep(solver_, schedule_.deaths, [&] { start_solver(); });
    keep(producer_, schedule_.pauses, [&] { start_producer(); });
  }
  if (!observer_) {
    try {
      observer_.emplace(stream_);
    } catch (const NoSuchStream&) {
      return;
    }
  }
  if (ipc::Internals::summary(*observer_, summary_) && t <= kSettling)
    passed_at_start_ = summary_.passed_over;
}

LiveSeen LiveRow::finish() {
  const nlohmann::json read = reader_->result();
  if (observer_) (void)ipc::Internals::summary(*observer_, summary_);
  const auto reason = [&](Refusal refusal) {
    return summary_.reasons[static_cast<std::size_t>(refusal)];
  };
  const std::uint64_t late = reason(Refusal::past);
  return {.peak_velocity = read.at("velocity"),
          .peak_acceleration = read.at("acceleration"),
          .error_p99 = read.at("p99"),
          .largest_error = read.at("largest"),
          .holding = read.at("holding"),
          .samples = read.at("samples"),
          .steps = read.at("steps"),
          .revised = read.at("revised"),
          .refused = summary_.refused - late + facts_->refused_calls,
          .came_late = late + facts_->late_calls,
          .passed_over = summary_.passed_over,
          .passed_at_start = passed_at_start_,
          .knots = summary_.knots,
          .late_commits = summary_.late_commits,
          .deadline_misses = summary_.deadline_misses,
          .kills = kills_,
          .producer_late = static_cast<double>(facts_->producer_late) * 1e-9,
          .solver_late = static_cast<double>(facts_->solver_late) * 1e-9};
}

}  // namespace splinecast::campaign
