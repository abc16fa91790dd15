#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>

#include "apps/streams/report.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {
namespace {

constexpr ipc::RegionKind kWaypoints = ipc::RegionKind::waypoints;
constexpr ipc::RegionKind kSpline = ipc::RegionKind::spline;
constexpr ipc::RegionKind kCommander = ipc::RegionKind::commander;
constexpr const char* kCommanderName = "c";

/// Files with the regions of an image, under a name of this process, until the end of the scope.
class Files {
 public:
  explicit Files(const StreamImage& image) : name_("test." + std::to_string(getpid()) + ".fuzz") {
    write(name_, kWaypoints, image.ring);
    write(name_, kSpline, image.board);
    if (!image.commander.empty()) write(commander(), kCommander, image.commander);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  ~Files() {
    for (const auto kind : {kWaypoints, kSpline}) {
      ipc::unlink_region(name_, kind);
      unlink(ipc::lock_path(name_, kind).c_str());
    }
    ipc::unlink_region(commander(), kCommander);
    unlink(ipc::lock_path(commander(), kCommander).c_str());
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] std::string commander() const {
    return ipc::commander_stream(name_, kCommanderName);
  }
  static void write(const std::string& name, ipc::RegionKind kind, std::vector<ipc::Word> words) {
    constexpr std::size_t kNamespaceWord = ipc::word_of(ipc::kHeaderFields, "time namespace");
    // A live seed may come from another machine: replaces kHere by this process's time namespace.
    if (words.size() > kNamespaceWord && words[kNamespaceWord] == kHere) {
      words[kNamespaceWord] = ipc::time_namespace();
    }
    const std::string path = ipc::region_path(name, kind);
    const auto bytes = std::as_bytes(std::span(words));
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),  // NOLINT(*-reinterpret-cast)
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    chmod(path.c_str(), S_IRUSR | S_IWUSR);
  }

  std::string name_;
};

/// Runs an action. Ignores the exceptions that the roles document.
void attempt(const auto& action) {
  try {
    action();
  } catch (const StreamError&) {
    return;
  } catch (const std::invalid_argument&) {
    return;
  }
}

void read(const std::string& name) {
  Reader reader(name);
  State state(reader.dimensions());
  const Time first = reader.first_time().value_or(Time(0));
  ipc::Summary summary;
  (void)ipc::Internals::summary(reader, summary);
  for (const Time t : {first, summary.settled_until, summary.newest_time, Time::max()}) {
    if (!has_values(reader.sample(t, state))) continue;
    for (const double value : state.values()) {
      require(value - value == 0, "a status with values has numbers in all dimensions");
    }
  }
  (void)reader.wait(Time(0));
  (void)reader.alive();
  (void)reader.names();
}

void notify(const std::string& name) {
  const ipc::StreamInfo info = ipc::inspect(name);
  require(!apps::pretty(apps::to_json(info)).empty(), "info prints a report");
}

void solve(const std::string& name) {
  Solver solver(name, {});
  const MonotonicClock clock;
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps && solver.attach(); ++i) {
    (void)solver.step(clock);
    solver.wait(Time(0));
  }
}

ProducerOptions options_of(const std::string& name) {
  const auto header = ipc::peek_header(name, kWaypoints, {});
  if (!header || header->dimensions < 1 || header->dimensions > kMaxDimensions) return {};
  return {.dimensions = header->dimensions,
          .names = ipc::dimension_names(*header),
          .units = ipc::dimension_units(*header),
          .kinds = ipc::dimensions_of(*header),
          .clock = ipc::stream_clock(*header),
          .start = ipc::start_condition(*header),
          .limits = {.min_interval = Time(header->min_interval),
                     .max_interval = Time(header->max_interval)},
          .capacity = 4};
}

void produce(const std::string& name, Script script) {
  const ProducerOptions options = options_of(name);
  Producer producer(name, options);
  std::vector<double> values(options.dimensions);
  constexpr int kAppends = 4;
  for (int i = 0; i < kAppends; ++i) {
    for (double& value : values) value = script.byte();
    (void)producer.append({.time = script.near(producer.last_time()), .position = values});
    (void)producer.earliest();
  }
  (void)producer.replace_from(script.near(producer.last_time()), {});
  (void)producer.wait_for_room(Time(0));
  (void)producer.finish({.kind = ConditionKind::halt, .value = {}});
}

/// Makes requests of a law, whether or not its regions are sound.
void command(const std::string& law, Script script) {
  RateCommander commander(law, kCommanderName);
  (void)commander.renew();
  const MonotonicClock clock;
  Solver solver(law, {});
  for (int i = 0; i < 3 && solver.attach(); ++i) {
    const Time ramp(1'000'000 + static_cast<Time::rep>(script.below(100)) * 1'000'000);
    const double rate = static_cast<double>(script.below(256)) / 255;
    const auto number = commander.set_rate(rate, ramp);
    (void)solver.step(clock);
    (void)commander.wait_in_force(number, Time(0));
    if (script.byte() % 2 == 0) commander.set_dead_man(ramp, ramp);
    (void)commander.renew();
  }
  (void)commander.release(Time(1'000'000));
  (void)solver.step(clock);
}

/// The roles of a stream that follows a law.
void follow(const std::string& law, const std::string& name, Script script) {
  Producer producer(name, {.dimensions = 1, .clock = StreamClock::law, .law = law, .capacity = 8});
  Solver solver(name, {});
  const MonotonicClock clock;
  State state(1);
  Time t = producer.now();
  for (int i = 0; i < 4 && solver.attach(); ++i) {
    const std::array position{static_cast<double>(script.byte())};
    t = script.near(t + Time(100'000'000));
    (void)producer.append({.time = t, .position = position});
    (void)solver.step(clock);
    if (i == 2) (void)producer.replace_from(producer.earliest(), {});
  }
  Reader reader(name);
  for (const Time ahead : {Time(0), Time(1'000'000), Time(1'000'000'000)}) {
    if (!has_values(reader.preview(clock.now() + ahead, state))) continue;
    for (const double value : state.values()) {
      require(value - value == 0, "a status with values has numbers in all dimensions");
    }
  }
  (void)reader.settled_until();
  (void)reader.progress();
}

/// A law, its commander, and a stream that follows it.
void try_law(const std::string& law, const Script& script) {
  const std::string arm = law + ".arm";
  attempt([&] { command(law, script); });
  attempt([&] { follow(law, arm, script); });
  attempt([&] { notify(arm); });
  attempt([&] { command(law, script); });
  attempt([&] { remove_stream(arm); });
}

}  // namespace

void try_roles(const StreamImage& image) {
  const Files files(image);
  const std::string& name = files.name();
  attempt([&] { read(name); });
  attempt([&] { notify(name); });
  attempt([&] { solve(name); });
  attempt([&] { produce(name, Script(image.script)); });
  attempt([&] { solve(name); });
  attempt([&] { read(name); });
  if (!image.commander.empty()) try_law(name, Script(image.script));
  attempt([&] { remove_stream(name); });
}

void try_all(const StreamImage& image) {
  try_reader(image);
  try_writers(image);
  try_roles(image);
}

}  // namespace splinecast::fuzz
