#include "apps/demo/chaos.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "apps/demo/chaos_producer.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/child.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/attach.hpp"
#include "apps/streams/solve.hpp"
#include "apps/trials/curve_watch.hpp"
#include "apps/trials/joint_motion.hpp"
#include "apps/trials/judgement.hpp"
#include "apps/trials/recovery.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr Time kTick = milliseconds(1);
constexpr Time kPatience = std::chrono::seconds(10);
/// Mean number per second.
constexpr double kSolverKills = 0.7;
constexpr double kProducerKills = 0.7;
constexpr double kPauses = 0.7;

json to_json(const WatchReport& report) {
  json by_status = json::object();
  for (std::size_t i = 0; i < report.by_status.size(); ++i) {
    by_status[std::string(to_string(static_cast<SampleStatus>(i)))] = report.by_status[i];
  }
  return {{"samples", report.samples},
          {"by_status", by_status},
          {"changed", report.changed},
          {"joins", report.knots},
          {"position_step", report.position_step},
          {"velocity_step", report.velocity_step},
          {"unpublished_acceleration_step", report.unpublished_step},
          {"acceleration_step", report.acceleration_step},
          {"acceleration", report.acceleration},
          {"sound", is_sound(report)}};
}

/// Samples as a controller does until the stream has ended.
json run_chaos_reader(const std::string& stream) {
  Reader reader = attach_reader(stream, kPatience);
  CurveWatch watch(ipc::Internals::sampler(reader), reader.dimensions());
  const MonotonicClock clock;
  ipc::Summary summary;
  Time due = clock.now();
  while (sleep_until(due)) {
    due = std::max(due + kTick, clock.now() - kTick);
    const Time now = clock.now();
    const auto status = watch.tick(now);
    if (status == SampleStatus::holding && ipc::Internals::summary(reader, summary) &&
        summary.finished)
      break;
  }
  return to_json(watch.report());
}

class Chaos {
 public:
  explicit Chaos(std::string stream)
      : stream_(std::move(stream)),
        start_(clock_.now() + milliseconds(700)),
        random_(std::random_device()()) {
    start_solver();
    start_producer();
    for (int r = 0; r < 2; ++r) readers_.emplace_back([&] { return run_chaos_reader(stream_); });
    reader_.emplace(attach_reader(stream_, kPatience));
    watch_.emplace(ipc::Internals::sampler(*reader_), reader_->dimensions());
  }

  json run(Time duration, bool quiet) {
    const Time begin = clock_.now();
    Time due = begin;
    Time line = begin;
    while (clock_.now() - begin < duration && sleep_until(due)) {
      due = std::max(due + kTick, clock_.now() - kTick);
      tick();
      if (quiet || clock_.now() < line) continue;
      print_line(clock_.now() - begin);
      line += std::chrono::seconds(1);
    }
    return finish();
  }

 private:
  void start_solver() {
    std::vector<double> limits = JointMotion::peak_acceleration();
    for (double& limit : limits) limit *= 10;
    solver_.emplace([this, limits] {
      return json(run_solve(
          {.wanted = {stream_},
           .solver = {.stop_time = milliseconds(250), .limits = {{.acceleration = limits}}},
           .quiet = true}));
    });
  }
  void start_producer() {
    producer_.emplace([this] { return run_chaos_producer(stream_, start_); });
  }
  bool happens(double per_second) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < per_second * to_seconds(kTick);
  }

  void tick() {
    const Time now = clock_.now();
    watch_->tick(now);
    (void)ipc::Internals::summary(*reader_, summary_);
    if (solver_down_.is_awaited() && summary_.revision > revision_then_) solver_down_.end(now);
    if (producer_down_.is_awaited() && summary_.consumed > appended_then_) producer_down_.end(now);
    if (resumes_ && now >= *resumes_) {
      solver_->signal(SIGCONT);
      resumes_.reset();
    }
    if (resumes_ || solver_down_.is_awaited()) return;
    if (happens(kPauses)) {
      ++pauses_;
      solver_->signal(SIGSTOP);
      resumes_ = now + milliseconds(std::uniform_int_distribution<int>(1, 200)(random_));
    } else if (happens(kSolverKills)) {
      solver_.reset();  // SIGKILL
      (void)ipc::Internals::summary(*reader_, summary_);
      revision_then_ = summary_.revision;
      solver_down_.begin(clock_.now());
      start_solver();
    } else if (!producer_down_.is_awaited() && happens(kProducerKills)) {
      producer_.reset();
      appended_then_ = ipc::inspect(stream_).appended;
      producer_down_.begin(clock_.now());
      start_producer();
    }
  }

  void print_line(Time since) {
    const WatchReport& report = watch_->report();
    if (lines_++ % 20 == 0) {
      print_report(fmt::format("{:>5} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>7} {:>9} {:>9}\n", "s",
                               "samples", "kills", "pauses", "starved", "knots", "refused",
                               "changed", "pos step", "vel step"));
    }
    print_report(fmt::format(
        "{:>5.0f} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>7} {:>9.1e} {:>9.1e}\n", to_seconds(since),
        report.samples, kills(), pauses_, summary_.underruns, summary_.knots, summary_.refused,
        report.changed, report.position_step, report.velocity_step));
  }

  [[nodiscard]] std::size_t kills() const {
    return solver_down_.result()["kills"].get<std::size_t>() +
           producer_down_.result()["kills"].get<std::size_t>();
  }

  /// Reads the curve until the stream has ended and is at rest, for at most kPatience.
  void watch_until_rest() {
    const Time end = deadline(clock_, kPatience);
    for (Time due = clock_.now(); clock_.now() < end && sleep_until(due);
         due = clock_.now() + kTick) {
      const SampleStatus status = watch_->tick(clock_.now());
      const bool has_ended = ipc::Internals::summary(*reader_, summary_) && summary_.finished;
      if (has_ended && status == SampleStatus::holding) break;
    }
  }

  /// Stops the producer, which ends the stream; unless interrupted, all readers must see it come to
  /// rest.
  json finish() {
    if (resumes_) solver_->signal(SIGCONT);
    producer_->stop();
    const json sent = producer_->result();
    watch_until_rest();
    json seen = json::array({to_json(watch_->report())});
    for (Child& reader : readers_) seen.push_back(reader.result());
    solver_->stop();
    solver_->result();
    (void)ipc::Internals::summary(*reader_, summary_);
    const ipc::StreamInfo info = ipc::inspect(stream_);
    const ipc::Word lost = info.appended - (summary_.knots + summary_.refused + summary_.withdrawn +
                                            summary_.controls);
    const bool all_sound =
        std::ranges::all_of(seen, [](const json& one) { return one["sound"].get<bool>(); });
    json found = {
        {"lost", lost},
        {"items", info.appended},
        {"interpolated", summary_.interpolated()},
        {"passed_over", summary_.passed_over},
        {"refused", summary_.refused},
        {"withdrawn", summary_.all_withdrawn()},
        {"replacements", std::max<ipc::Word>(summary_.controls, 1) - 1},
        {"underruns", summary_.underruns},
        {"deadline_misses", summary_.deadline_misses},
        {"late_commits", summary_.late_commits},
        {"pauses", pauses_},
        {"solver", solver_down_.result()},
        {"producer", producer_down_.result()},
        {"readers", seen},
        {"peak_acceleration_of_the_motion", std::ranges::max(JointMotion::peak_acceleration())}};
    add_judgement(found, all_sound && lost == 0 && summary_.finished);
    return found;
  }

  std::string stream_;
  MonotonicClock clock_;
  Time start_;
  std::mt19937_64 random_;
  std::optional<Child> solver_;
  std::optional<Child> producer_;
  std::vector<Child> readers_;
  std::optional<Reader> reader_;
  std::optional<CurveWatch> watch_;
  ipc::Summary summary_;
  Recovery solver_down_;
  Recovery producer_down_;
  ipc::Word revision_then_ = 0;
  ipc::Word appended_then_ = 0;
  std::optional<Time> resumes_;
  std::size_t pauses_ = 0;
  std::size_t lines_ = 0;
};

}  // namespace

json run_chaos(const std::string& stream, Time duration, bool quiet) {
  return Chaos(stream).run(duration, quiet);
}

std::string chaos_summary(const json& found) {
  const auto most = [&](const char* key) {
    double value = 0;
    for (const json& reader : found["readers"]) value = std::max(value, reader[key].get<double>());
    return value;
  };
  const auto recovery = [&](const char* role) {
    const json& of = found[role];
    return fmt::format("  {:<34} {} kills; recovery {:.1f} ms in the median, {:.1f} ms at most\n",
                       role, of["kills"].get<int>(), of["p50_ms"].get<double>(),
                       of["max_ms"].get<double>());
  };
  const auto line = [](const char* what, const std::string& text) {
    return fmt::format("  {:<34} {}\n", what, text);
  };
  const auto count = [&](const char* key) { return found[key].get<std::uint64_t>(); };
  std::string text(1, '\n');
  text += recovery("solver") + recovery("producer");
  text +=
      line("pauses of the solver, up to 200 ms", fmt::format("{}", count("pauses"))) +
      line("starvations", fmt::format("{}", count("underruns"))) +
      line("replacements of the future", fmt::format("{}", count("replacements"))) +
      line("waypoints",
           fmt::format("{} interpolated, {} passed over, {} refused with a reason, {} withdrawn, "
                       "{} {}",
                       count("interpolated"), count("passed_over"), count("refused"),
                       count("withdrawn"), count("lost"),
                       found["judged"].get<bool>() ? "lost" : "not consumed")) +
      line("settled samples that changed",
           fmt::format("{:.0f} of {:.0f}", most("changed"), most("samples"))) +
      line("largest step at a join", fmt::format("position {:.1e}, velocity {:.1e}",
                                                 most("position_step"), most("velocity_step"))) +
      line("acceleration",
           fmt::format("{:.1f} at most; the motion's own is {:.1f}", most("acceleration"),
                       found["peak_acceleration_of_the_motion"].get<double>())) +
      line("deadline_misses",
           fmt::format("{}; late_commits: {}", count("deadline_misses"), count("late_commits"))) +
      line("sound", judgement(found));
  return text;
}

}  // namespace splinecast::apps
