#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/demo/chaos.hpp"
#include "apps/demo/controller.hpp"
#include "apps/demo/pick_and_place.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/child.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/replay/player.hpp"
#include "apps/streams/remover.hpp"
#include "apps/streams/report.hpp"
#include "apps/streams/solve.hpp"
#include "apps/tables/table_rows.hpp"
#include "apps/trials/judgement.hpp"
#include "ipc/mapping/region.hpp"
#include "splinecast/rate_commander.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;

constexpr std::size_t kReaders = 2;
constexpr Time kDefaultLength = std::chrono::seconds(10);
// The waypoints and the readers' records are kept in memory.
constexpr Time kShortest = std::chrono::milliseconds(100);
constexpr Time kLongest = std::chrono::hours(1);
constexpr Time kLongestChaos = std::chrono::hours(24);

struct DemoOptions {
  std::string file;
  TableOptions table;
  std::optional<Time> seconds;
  std::string law;  ///< that the stream follows
  bool chaos = false;
  bool json = false;
};

json replay_json(const ReplayReport& report) {
  return {{"sent", report.sent},
          {"interpolated", report.interpolated},
          {"passed_over", report.passed_over},
          {"refused", report.refused},
          {"interrupted", report.interrupted},
          {"exit_code", exit_code(report)}};
}

/// Sums and largest values over the readers.
json merged(const std::vector<json>& readers) {
  json sum = readers.front();
  for (std::size_t r = 1; r < readers.size(); ++r) {
    sum["samples"] = sum["samples"].get<std::size_t>() + readers[r]["samples"].get<std::size_t>();
    for (std::size_t i = 0; i < sum["by_status"].size(); ++i) {
      sum["by_status"][i] =
          sum["by_status"][i].get<std::size_t>() + readers[r]["by_status"][i].get<std::size_t>();
    }
    for (const char* const key : {"step_at_knots", "change_of_the_past", "age_ms", "sample_ns"}) {
      for (std::size_t i = 0; i < sum[key].size(); ++i) {
        sum[key][i] = std::max(sum[key][i].get<double>(), readers[r][key][i].get<double>());
      }
    }
  }
  return sum;
}

std::string line(const char* what, const std::string& text) {
  return fmt::format("  {:<34} {}\n", what, text);
}

std::string steps_line(const char* what, const json& steps) {
  return line(what,
              fmt::format("position {:.2g}, velocity {:.2g}, acceleration {:.2g}",
                          steps[0].get<double>(), steps[1].get<double>(), steps[2].get<double>()));
}

std::string counts_by_status(const json& by_status) {
  std::string text;
  for (std::size_t i = 0; i < by_status.size(); ++i) {
    const auto count = by_status[i].get<std::size_t>();
    if (count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count,
                        to_string(static_cast<SampleStatus>(i)));
  }
  return text;
}

std::string summary(const WaypointTable& table, const json& sent, const json& read) {
  return fmt::format(
             "\nOne producer, one solver and {} readers, each in its own process; {} dimensions "
             "from {}, played live.\n\n",
             kReaders, table.dimensions(), table.file) +
         line("waypoints",
              fmt::format("{} sent, {} interpolated{}, {} refused", sent["sent"].get<std::size_t>(),
                          sent["interpolated"].get<std::size_t>(),
                          passed_over_in_words(sent["passed_over"].get<ipc::Word>()),
                          sent["refused"].get<std::size_t>())) +
         line("samples at 1 kHz", fmt::format("{} in total: {}", read["samples"].get<std::size_t>(),
                                              counts_by_status(read["by_status"]))) +
         steps_line("largest step at a knot", read["step_at_knots"]) +
         steps_line("largest change of past samples", read["change_of_the_past"]) +
         line("age of the data",
              fmt::format("{:.1f} ms in the median, {:.1f} ms at most",
                          read["age_ms"][0].get<double>(), read["age_ms"][1].get<double>())) +
         line("time per sample",
              fmt::format("{:.0f} ns in the median, {:.0f} ns for 99 of 100",
                          read["sample_ns"][0].get<double>(), read["sample_ns"][1].get<double>()));
}

int run_chaos_demo(const DemoOptions& options, const std::string& stream) {
  catch_stop_signals();
  const StreamRemover remover({stream});
  const auto run = [&] {
    return run_chaos(stream, options.seconds.value_or(kDefaultLength), options.json);
  };
  return print_judgement(run, options.json, chaos_summary, kFellShort);
}

/// The time law of a demo. Made here, at rate 1, unless a solver has begun it.
class DemoLaw {
 public:
  explicit DemoLaw(const std::string& law) {
    if (law.empty() || ipc::region_exists(law, ipc::RegionKind::spline)) return;
    made_.push_back(law);
    commander_.emplace(law, "demo").set_rate(1, std::chrono::milliseconds(100));
    say(fmt::format("'splinecast rate {} 0.3' in another terminal slows the motion down", law));
  }
  /// What the demo solves, with its stream.
  [[nodiscard]] std::vector<std::string> with(const std::string& stream) const {
    std::vector<std::string> all{stream};
    all.insert(all.end(), made_.begin(), made_.end());
    return all;
  }
  void end() { commander_.reset(); }

 private:
  std::vector<std::string> made_;
  std::optional<RateCommander> commander_;
};

void print_demo(const DemoOptions& options, const WaypointTable& table, const json& sent,
                const std::vector<json>& seen) {
  const json read = merged(seen);
  if (!options.json) return print_report(summary(table, sent, read));
  const json all{{"interrupted", stop_requested()},
                 {"waypoints", sent},
                 {"readers", seen},
                 {"all_readers", read}};
  print_report(all.dump(2) + "\n");
}

int run_demo(const DemoOptions& options) {
  const std::string stream = fmt::format("demo.{}", getpid());
  if (options.chaos) return run_chaos_demo(options, stream);
  WaypointTable table = options.file.empty()
                            ? pick_and_place(options.seconds.value_or(kDefaultLength))
                            : read_waypoints(options.file, options.table);
  ReplayOptions replay{.stream = stream, .start_from = FromFirst{}};
  if (!options.file.empty()) replay.duration = options.seconds;
  if (!options.law.empty()) {
    replay.ring.law = options.law;
    replay.ring.clock = StreamClock::law;
  }
  RefusedRows refused;
  Recording recording(std::make_unique<TableRows>(table), table.kinds, preparation_of(replay),
                      nullptr);

  catch_stop_signals();
  DemoLaw law(options.law);
  const StreamRemover remover(law.with(stream));
  Child solver([&] { return json(run_solve({.wanted = law.with(stream), .quiet = true})); });
  std::vector<Child> readers;
  for (std::size_t r = 0; r < kReaders; ++r) {
    readers.emplace_back([&] { return run_demo_reader(stream); });
  }
  Child producer([&] { return replay_json(replay_recording(recording, replay, refused)); });

  const json sent = producer.result();
  std::vector<json> seen;
  seen.reserve(readers.size());
  for (Child& reader : readers) seen.push_back(reader.result());
  solver.stop();
  solver.result();
  law.end();
  print_demo(options, table, sent, seen);
  if (stop_requested()) throw Interrupted("interrupted");
  return sent["exit_code"].get<int>();
}

void add_demo(Command& verb, Action& action) {
  auto options = std::make_shared<DemoOptions>();
  const Argument file =
      verb.option("--file", options->file,
                  "Waypoint file to play (default: a pick-and-place motion of seven joints)")
          .type("FILE");
  add_seconds(
      verb, "--seconds", options->seconds,
      "Length to play in s, 0.1 to 3600, with --chaos up to 86400 (default 10, or the whole file)",
      {kShortest, kLongestChaos});
  const Argument law = verb.option("--law", options->law,
                                   "Time law that the stream follows; it is made if there is none")
                           .type("LAW");
  verb.flag("--chaos", options->chaos,
            "Kill, pause and starve the processes while the readers check every sample; exit code "
            "3 if a check fails")
      .excludes(file)
      .excludes(law);
  verb.flag("--json", options->json, "Print JSON");
  add_table_options(verb, options->table);
  verb.callback([&action, options] {
    if (options->seconds && *options->seconds > kLongest && !options->chaos) {
      throw UsageError(
          "--seconds",
          fmt::format("'{}' is not a time from 0.1 to 3600 s, the range without --chaos",
                      to_seconds(*options->seconds)));
    }
    action = [options] { return run_demo(*options); };
  });
}

const Verb demo_verb(
    "demo", 10,
    "Run a producer, a solver and two readers as processes, and report what the readers saw",
    add_demo);

}  // namespace

}  // namespace splinecast::apps
