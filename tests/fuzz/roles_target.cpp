#include <sys/stat.h>
#include <unistd.h>

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
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {
namespace {

constexpr ipc::RegionKind kWaypoints = ipc::RegionKind::waypoints;
constexpr ipc::RegionKind kSpline = ipc::RegionKind::spline;

/// Files with the regions of an image, under a name of this process, until the end of the scope.
class Files {
 public:
  explicit Files(const StreamImage& image) : name_("test." + std::to_string(getpid()) + ".fuzz") {
    write(kWaypoints, image.ring);
    write(kSpline, image.board);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  ~Files() {
    for (const auto kind : {kWaypoints, kSpline}) {
      ipc::unlink_region(name_, kind);
      unlink(ipc::lock_path(name_, kind).c_str());
    }
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void write(ipc::RegionKind kind, std::vector<ipc::Word> words) const {
    constexpr std::size_t kNamespaceWord = ipc::word_of(ipc::kHeaderFields, "time namespace");
    // A live seed may come from another machine: replaces kHere by this process's time namespace.
    if (words.size() > kNamespaceWord && words[kNamespaceWord] == kHere) {
      words[kNamespaceWord] = ipc::time_namespace();
    }
    const std::string path = ipc::region_path(name_, kind);
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

void tell(const std::string& name) {
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
          .limits = ipc::ingest_limits(*header),
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

}  // namespace

void try_roles(const StreamImage& image) {
  const Files files(image);
  const std::string& name = files.name();
  attempt([&] { read(name); });
  attempt([&] { tell(name); });
  attempt([&] { solve(name); });
  attempt([&] { produce(name, Script(image.script)); });
  attempt([&] { solve(name); });
  attempt([&] { read(name); });
  attempt([&] { remove_stream(name); });
}

void try_all(const StreamImage& image) {
  try_reader(image);
  try_writers(image);
  try_roles(image);
}

}  // namespace splinecast::fuzz
