#include "tests/campaign/motions/trial.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::campaign {
namespace {

constexpr int kMilliseconds = 1000;
constexpr int kLead = 500;       ///< ms: largest lead of the first call
constexpr double kSettling = 2;  ///< s: errors are measured from here on

Time to_time(double seconds) { return Time(std::llround(seconds * 1e9)); }

core::WindowOptions live(core::WindowOptions window) {
  window.held_before_start = true;
  window.start.kind = ConditionKind::halt;
  return window;
}

}  // namespace

double Seen::peak_velocity() const { return *std::ranges::max_element(peak_velocities); }
double Seen::peak_acceleration() const { return *std::ranges::max_element(peak_accelerations); }

Time Trial::stream_time(double t) {
  constexpr Time kBegin{1'000'000'000'000};
  return kBegin + to_time(t);
}

Trial::Trial(const Motion& motion, const Schedule& schedule, TrialOptions options)
    : motion_(motion),
      schedule_(schedule),
      options_(std::move(options)),
      random_(options_.seed),
      stream_(motion.joints(), live(options_.window), 4096, 4096, {}, {}, ipc::LiveOptions{}),
      sampler_(stream_.board.reader, StreamClock::monotonic, {}),
      snapshot_(motion.joints()),
      state_(motion.joints()),
      ms_(-kLead) {
  stream_.beyond = options_.beyond;
  stream_.replace_solver();
  seen_.peak_velocities.resize(motion.joints());
  seen_.peak_accelerations.resize(motion.joints());
}

Seen Trial::run() {
  const int end = static_cast<int>(motion_.seconds() * kMilliseconds);
  while (ms_ < end) tick();
  const auto past = summary().reasons[static_cast<std::size_t>(Refusal::past)];
  seen_.past += past;
  seen_.refused = summary().refused - past + refused_;
  seen_.knots = summary().knots;
  seen_.passed_over = summary().passed_over;
  seen_.starvations = summary().underruns;
  seen_.holding = samples_ > 0 ? static_cast<double>(held_) / static_cast<double>(samples_) : 1;
  std::ranges::sort(seen_.errors);
  return std::move(seen_);
}

void Trial::tick() {
  now_ = static_cast<double>(ms_) / kMilliseconds;
  stream_.clock.time = stream_time(now_);
  produce();
  solve();
  read();
  if (now_ <= kSettling) seen_.passed_at_start = summary().passed_over;
  ++ms_;
}

void Trial::produce() {
  for (; next_ < schedule_.calls.size() && schedule_.calls[next_].at <= now_; ++next_) {
    send(schedule_.calls[next_]);
  }
  if (schedule_.finish_at && *schedule_.finish_at <= now_ && !is_finished_) finish();
}

void Trial::finish() {
  const ipc::WaypointRingWriter::Solved solved{.consumed = stream_.board.reader.consumed()};
  const Condition halt{.kind = ConditionKind::halt, .value = {}};
  is_finished_ = stream_.ring.writer.finish(halt, solved) == AppendStatus::accepted;
}

void Trial::send(const Call& call) {
  std::vector<std::vector<double>> positions = call.positions;
  std::normal_distribution<> noise(0, options_.noise);
  std::vector<Waypoint> waypoints;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (double& x : positions[i]) {
      if (options_.noise > 0) x += noise(random_);
      if (options_.quantum > 0) x = std::round(x / options_.quantum) * options_.quantum;
    }
    waypoints.push_back({.time = stream_time(call.times[i]), .position = positions[i]});
  }
  const ipc::WaypointRingWriter::Solved solved{
      .consumed = stream_.board.reader.consumed(),
      .settled_until = stream_.board.reader.look().settled_until,
      .clock = &stream_.clock};
  if (call.replaces_from) {
    count(stream_.ring.writer.replace_from(stream_time(*call.replaces_from), waypoints, solved));
    return;
  }
  for (const Waypoint& waypoint : waypoints) {
    count(stream_.ring.writer.append(waypoint, solved));
  }
}

void Trial::count(AppendStatus status) {
  seen_.past += status == AppendStatus::past ? 1U : 0U;
  const bool is_fine = status == AppendStatus::accepted || status == AppendStatus::past;
  refused_ += is_fine ? 0U : 1U;
}

void Trial::solve() {
  constexpr int kStepsPerMillisecond = 8;
  if (death_ < schedule_.deaths.size() && now_ >= schedule_.deaths[death_].first) {
    if (now_ < schedule_.deaths[death_].second) return;
    stream_.replace_solver();
    ++death_;
  }
  for (int i = 0; i < kStepsPerMillisecond; ++i) {
    const auto result = stream_.solver.step(stream_.clock);
    if (result.consumed == 0 && stream_.solver.due() > stream_.clock.time) return;
  }
}

void Trial::read() {
  const auto status = sampler_.sample(stream_.clock.time, state_);
  if (!has_values(status)) return;
  const SegmentKind kind = this->kind();
  if (options_.watch) options_.watch({now_, status, kind, summary().underruns, &state_});
  if (now_ < 0) return;
  const auto is_now = [&](const auto& pause) { return now_ >= pause.first && now_ < pause.second; };
  if (std::ranges::none_of(schedule_.pauses, is_now) &&
      std::ranges::none_of(schedule_.deaths, is_now)) {
    ++samples_;
    held_ += status == SampleStatus::holding ? 1U : 0U;
  }
  double error = 0;
  const double offset = schedule_.offset(now_);
  for (std::size_t joint = 0; joint < motion_.joints(); ++joint) {
    error = std::max(error, std::abs(state_.position()[joint] - motion_.at(joint, now_) - offset));
    double& velocity = seen_.peak_velocities[joint];
    velocity = std::max(velocity, std::abs(state_.velocity()[joint]));
    double& acceleration = seen_.peak_accelerations[joint];
    acceleration = std::max(acceleration, std::abs(state_.acceleration()[joint]));
  }
  if (kind == SegmentKind::entry) {
    for (const double a : state_.acceleration()) {
      seen_.entry_acceleration = std::max(seen_.entry_acceleration, std::abs(a));
    }
  }
  if (now_ >= kSettling) seen_.errors.push_back(error);
}

SegmentKind Trial::kind() {
  const Time t = stream_.clock.time;
  if (!has_values(sampler_.snapshot(t, t, snapshot_))) return SegmentKind::spline;
  const auto segments = snapshot_.segments();
  const auto at = std::ranges::find_if(
      segments, [&](const ipc::SegmentCopy& s) { return s.left <= t && t < s.right; });
  return at != segments.end() ? at->kind : SegmentKind::spline;
}

}  // namespace splinecast::campaign
