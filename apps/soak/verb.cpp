#include "apps/soak/roles.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <deque>
#include <memory>
#include <optional>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/child.hpp"
#include "apps/process/descriptors.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "apps/process/use.hpp"
#include "apps/streams/attach.hpp"
#include "apps/streams/remover.hpp"
#include "apps/streams/solve.hpp"
#include "apps/trials/judgement.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kMostProducers = 4;  ///< processes
/// About as many as a process can open (RLIMIT_NOFILE, two descriptors per stream).
constexpr std::size_t kMostStreams = 10'000;
constexpr std::size_t kMostReaders = 64;  ///< processes
constexpr double kMostRate = 1000;
constexpr Time kBetweenKills = seconds(2);
constexpr Time kPatience = seconds(60);
constexpr double kMegabyte = 1e6;
constexpr std::size_t kLeastLooks = 16;  ///< for a judgement of growth
/// Memory that an allocator may still request after the warm-up, and files that are open briefly.
constexpr std::size_t kMemoryTolerance = 512UL * 1024;
constexpr std::size_t kDescriptorTolerance = 4;

/// The processes of one role, and the largest use of resources among them.
struct Role {
  const char* name;
  std::deque<std::optional<Child>> processes{};
  Flatness memory{kMemoryTolerance};    ///< private; shared pages grow as a board fills
  Flatness mappings{kMemoryTolerance};  ///< with shared pages
  Flatness descriptors{kDescriptorTolerance};
  ProcessUse now{};

  /// Measures all of them.
  void look() {
    now = {};
    for (const auto& child : processes) {
      const auto use = process_use(child->pid());
      if (!use) continue;
      now.private_bytes = std::max(now.private_bytes, use->private_bytes);
      now.mapped_bytes = std::max(now.mapped_bytes, use->mapped_bytes);
      now.descriptors = std::max(now.descriptors, use->descriptors);
    }
    memory.add(now.private_bytes);
    mappings.add(now.mapped_bytes);
    descriptors.add(now.descriptors);
  }
  [[nodiscard]] bool has_grown() const {
    return memory.has_grown() || mappings.has_grown() || descriptors.has_grown();
  }
  [[nodiscard]] json result() const {
    return {{"processes", processes.size()},
            {"private_bytes", {memory.first(), memory.second()}},
            {"mapped_bytes", {mappings.first(), mappings.second()}},
            {"descriptors", {descriptors.first(), descriptors.second()}},
            {"grown", has_grown()}};
  }
};

class Soak {
 public:
  Soak(const SoakOptions& options, std::vector<std::string> streams)
      : options_(options),
        streams_(std::move(streams)),
        start_(clock_.now() + seconds(1)),
        groups_(std::min(kMostProducers, streams_.size())) {
    solver_.processes.emplace_back(std::in_place, [this] { return solve(); });
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      for (std::size_t i = g; i < streams_.size(); i += groups_.size()) {
        groups_[g].push_back(streams_[i]);
      }
      producers_.processes.emplace_back(std::in_place, [this, g] { return produce(g); });
    }
    for (std::size_t r = 0; r < options.readers; ++r) {
      readers_.processes.emplace_back(std::in_place, [this] { return run_soak_reader(streams_); });
    }
    for (const std::string& stream : streams_)
      summaries_.push_back(attach_reader(stream, kPatience));
    // A restarted producer has some memory of this process. It must not look like growth, so all
    // producers have it from here on.
    for (std::size_t g = 0; g < groups_.size(); ++g) restart_producer(g);
  }

  json run() {
    sleep_until(start_);  // before this, the processes start up
    const Time begin = clock_.now();
    const Time end = begin + options_.seconds;
    const Time look = std::clamp<Time>(options_.seconds / 240, milliseconds(50), seconds(10));
    const Time line = std::max<Time>(seconds(1), options_.seconds / 240);
    Time next_kill = begin + kBetweenKills;
    Time next_line = begin;
    std::size_t looks = 0;
    for (Time due = begin; sleep_until(due);) {
      const Time now = clock_.now();
      for (Role* role : roles()) role->look();
      if (!options_.json && now >= next_line) {
        print_line(now - begin);
        next_line += line;
      }
      for (; next_kill <= std::min(now, end - Time(1)); next_kill += kBetweenKills) {
        restart_producer(kills_++ % groups_.size());
      }
      if (++looks >= kLeastLooks && now >= end) break;
      due = now < end ? std::min(now + look, end) : now + look;
    }
    const double took = to_seconds(std::max(clock_.now() - begin, Time(1)));
    return finish(took, to_seconds(cpu_time(solver_.processes.front()->pid())) / took);
  }

 private:
  [[nodiscard]] std::array<Role*, 3> roles() { return {&solver_, &producers_, &readers_}; }

  [[nodiscard]] json solve() const {
    const double kept = 1 + 1.2 * options_.rate;  // the history, the lead and a margin
    const auto capacity = std::bit_ceil(static_cast<std::size_t>(2 * kept) + 64);
    return run_solve({.wanted = {streams_.front().substr(0, streams_.front().rfind('.')) + ".*"},
                      .solver = {.capacity = capacity},
                      .quiet = true});
  }
  [[nodiscard]] json produce(std::size_t group) const {
    return run_soak_producers(groups_[group], options_.rate, start_);
  }

  /// Kills a producer by SIGKILL; a new one resumes its streams. Waits until the new one has closed
  /// the files that it inherits, so that they are not counted as its own.
  void restart_producer(std::size_t group) {
    std::optional<Child>& producer = producers_.processes[group];
    producer.reset();
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Failure("cannot create a pipe for a producer");
    producer.emplace([&, this] {
      summaries_.clear();
      for (const int end : ends) close(end);
      return produce(group);
    });
    close(ends[1]);
    char none = 0;
    while (read(ends[0], &none, 1) < 0 && errno == EINTR) {
    }
    close(ends[0]);
  }

  /// The sums of the counters in all streams' summaries.
  [[nodiscard]] json counted() const {
    ipc::Summary sum;
    ipc::Summary summary;
    for (const Reader& reader : summaries_) {
      if (!ipc::Internals::summary(reader, summary)) continue;
      sum.consumed += summary.consumed;
      sum.knots += summary.knots;
      sum.passed_over += summary.passed_over;
      sum.refused += summary.refused;
      sum.withdrawn += summary.all_withdrawn();
      sum.controls += summary.controls;
      sum.underruns += summary.underruns;
      sum.deadline_misses += summary.deadline_misses;
      sum.late_commits += summary.late_commits;
    }
    return {{"consumed", sum.consumed},        {"interpolated", sum.interpolated()},
            {"passed_over", sum.passed_over},  {"refused", sum.refused},
            {"withdrawn", sum.withdrawn},      {"controls", sum.controls},
            {"underruns", sum.underruns},      {"deadline_misses", sum.deadline_misses},
            {"late_commits", sum.late_commits}};
  }

  void print_line(Time since) {
    if (lines_++ % 20 == 0) {
      print_report(fmt::format("{:>7} {:>6} {:>10} {:>8} {:>7} {:>18} {:>18} {:>18}\n", "s",
                               "kills", "consumed", "refused", "starved", "solver MB, files",
                               "producer MB, files", "reader MB, files"));
    }
    const auto use = [](const Role& role) {
      return fmt::format("{:.2f} {:>6}", static_cast<double>(role.now.private_bytes) / kMegabyte,
                         role.now.descriptors);
    };
    const json sum = counted();
    const auto count = [&](const char* key) { return sum[key].get<ipc::Word>(); };
    print_report(fmt::format("{:>7.0f} {:>6} {:>10} {:>8} {:>7} {:>18} {:>18} {:>18}\n",
                             to_seconds(since), kills_, count("consumed"), count("refused"),
                             count("underruns"), use(solver_), use(producers_), use(readers_)));
  }

  /// Ends all processes. Returns whether the solver has ended with kOk; adds the readers' results.
  bool end_all(json& seen) {
    for (auto& producer : producers_.processes) producer->stop();
    for (auto& producer : producers_.processes) (void)producer->result();
    for (auto& reader : readers_.processes) {
      reader->stop();
      seen.push_back(reader->result());
    }
    solver_.processes.front()->stop();
    return solver_.processes.front()->result() == kOk;
  }

  /// Ends all processes and adds up the counters.
  json finish(double took, double solver_share) {
    json found = {{"streams", streams_.size()},
                  {"seconds", took},
                  {"rate", options_.rate},
                  {"producer_kills", kills_},
                  {"solver_share", solver_share}};
    bool is_flat = true;
    for (const Role* role : roles()) {
      found[role->name] = role->result();
      is_flat = is_flat && !role->has_grown();
    }
    json seen = json::array();
    const bool has_solved = end_all(seen);
    found["counters"] = counted();
    found["read"] = seen;
    ipc::Word appended = 0;
    std::size_t lossy = 0;
    std::size_t unfinished = 0;
    for (const std::string& stream : streams_) {
      const ipc::StreamInfo info = ipc::inspect(stream);
      const ipc::Summary& summary = info.summary;
      appended += info.appended;
      const ipc::Word accounted =
          summary.knots + summary.refused + summary.withdrawn + summary.controls;
      if (info.appended != accounted || summary.consumed != accounted) ++lossy;
      if (!summary.finished) ++unfinished;
    }
    found["appended"] = appended;
    found["lossy_streams"] = lossy;
    found["unfinished_streams"] = unfinished;
    const bool is_sound = std::ranges::all_of(
        seen, [](const json& one) { return one["unsound_streams"] == 0 && one["samples"] > 0; });
    add_judgement(found, is_flat && is_sound && has_solved && lossy == 0 && unfinished == 0);
    return found;
  }

  SoakOptions options_;
  std::vector<std::string> streams_;
  MonotonicClock clock_;
  Time start_;
  std::vector<std::vector<std::string>> groups_;  ///< the streams of each producer process
  Role solver_{"solver"};
  Role producers_{"producers"};
  Role readers_{"readers"};
  std::vector<Reader> summaries_;
  std::size_t kills_ = 0;
  std::size_t lines_ = 0;
};

std::uint64_t count_of(const json& of, const char* key) { return of[key].get<std::uint64_t>(); }

std::string summary_line(const char* what, const std::string& text) {
  return fmt::format("  {:<26} {}\n", what, text);
}

/// The processes of a role, and their use of memory and files.
std::string role_summary(const json& found, const char* name) {
  const json& of = found[name];
  return summary_line(
      name,
      fmt::format("{} processes; {:.2f} then {:.2f} MB, {} then {} files{}",
                  count_of(of, "processes"), of["private_bytes"][0].get<double>() / kMegabyte,
                  of["private_bytes"][1].get<double>() / kMegabyte, of["descriptors"][0].get<int>(),
                  of["descriptors"][1].get<int>(), of["grown"].get<bool>() ? ": GROWN" : ""));
}

/// The samples of all readers.
std::string samples_summary(const json& found) {
  std::uint64_t samples = 0;
  std::uint64_t changed = 0;
  std::uint64_t unsound = 0;
  for (const json& reader : found["read"]) {
    samples += count_of(reader, "samples");
    changed += count_of(reader, "changed");
    unsound += count_of(reader, "unsound_streams");
  }
  return summary_line("samples", fmt::format("{}; {} changed later; streams with a step: {}",
                                             samples, changed, unsound));
}

std::string soak_summary(const json& found) {
  const auto& line = summary_line;
  const auto& count = count_of;
  const json& sum = found["counters"];
  return std::string("\n") +
         line("streams",
              fmt::format("{} for {:.0f} s, {} waypoints per second each; the solver used {:.1f} % "
                          "of a core",
                          count(found, "streams"), found["seconds"].get<double>(),
                          found["rate"].get<double>(), 100 * found["solver_share"].get<double>())) +
         line("producers killed",
              fmt::format("{}, each restarted", count(found, "producer_kills"))) +
         line("items",
              fmt::format("{} appended: {} interpolated, {} passed over, {} refused with "
                          "a reason, {} withdrawn, {} controls; streams that lost one: {}",
                          count(found, "appended"), count(sum, "interpolated"),
                          count(sum, "passed_over"), count(sum, "refused"), count(sum, "withdrawn"),
                          count(sum, "controls"), count(found, "lossy_streams"))) +
         line("starved",
              fmt::format("{} times; deadline_misses {}, late_commits {}", count(sum, "underruns"),
                          count(sum, "deadline_misses"), count(sum, "late_commits"))) +
         samples_summary(found) + role_summary(found, "solver") + role_summary(found, "producers") +
         role_summary(found, "readers") + line("sound", judgement(found));
}

}  // namespace

json run_soak(const SoakOptions& options) {
  raise_descriptor_limit();
  std::vector<std::string> streams;
  for (std::size_t i = 0; i < options.streams; ++i) {
    streams.push_back(fmt::format("soak.{}.{}", getpid(), i));
  }
  const StreamRemover remover(streams);
  return Soak(options, streams).run();
}

namespace {

void add_soak(Command& verb, Action& action) {
  auto options = std::make_shared<SoakOptions>();
  add_count(verb, "--streams", options->streams, "Number of streams, 1 to 10000 (default 100)",
            {1, kMostStreams});
  add_seconds(verb, "--seconds", options->seconds, "Duration in s, from 1 (default 60)",
              {seconds(1), kLongestTime});
  add_rate(verb, "--rate", options->rate,
           "Waypoints per second and stream, 1 to 1000 (default 100)", {1, kMostRate});
  add_count(verb, "--readers", options->readers,
            "Reader processes, each of which reads all streams, 1 to 64 (default 2)",
            {1, kMostReaders});
  verb.flag("--json", options->json, "Print JSON, without the table");
  verb.callback([&action, options] {
    action = [options] {
      catch_stop_signals();
      return print_judgement([&] { return run_soak(*options); }, options->json, soak_summary,
                             kFailed);
    };
  });
}

const Verb soak_verb("soak", 140,
                     "Run many streams for a long time, kill producers, and check every sample, "
                     "memory and descriptors",
                     add_soak);

}  // namespace

}  // namespace splinecast::apps
