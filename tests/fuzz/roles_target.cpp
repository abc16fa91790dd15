#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "apps/streams/report.hpp"
#include "ipc/roles/stream_files.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {
namespace {

constexpr ipc::RegionKind kWaypoints = ipc::RegionKind::waypoints;
constexpr ipc::RegionKind kSpline = ipc::RegionKind::spline;

/// The regions of an image under a name of this process's own, until the end of the scope.
class Files {
 public:
  explicit Files(const StreamImage& image) : name_("fuzz" + std::to_string(getpid())) {
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
    // A live seed was made elsewhere, and says `here` where its clock's namespace stands.
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

/// Does something that may refuse, by what the roles say that they throw.
void attempt(const auto& action) {
  try {
    action();
  } catch (const ipc::StreamError&) {
    return;
  } catch (const std::invalid_argument&) {
    return;
  }
}

void read(const std::string& name) {
  ipc::Reader reader(name);
  core::State state(reader.dimensions());
  core::Time first{};
  ipc::Head head;
  if (!reader.first_time(first) || !reader.head(head)) first = core::Time(0);
  for (const core::Time t : {first, head.settled_until, head.newest_knot, core::Time::max()}) {
    if (!ipc::has_values(reader.sample(t, state))) continue;
    for (const double value : state.values()) {
      require(value - value == 0, "a status with values has numbers in all dimensions");
    }
  }
  (void)reader.wait(core::Time(0));
  (void)reader.alive();
  (void)reader.names();
}

void tell(const std::string& name) {
  const ipc::StreamInfo info = ipc::inspect(name);
  require(!apps::pretty(apps::to_json(info)).empty(), "info says something");
}

void solve(const std::string& name) {
  ipc::Solver solver(name, {});
  const ipc::MonotonicClock clock;
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps && solver.attach(); ++i) {
    (void)solver.step(clock);
    solver.wait(core::Time(0));
  }
}

ipc::ProducerOptions options_of(const std::string& name) {
  const auto header = ipc::peek_header(name, kWaypoints, {});
  if (!header || header->dimensions < 1 || header->dimensions > core::kMaxDimensions) return {};
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
  const ipc::ProducerOptions options = options_of(name);
  ipc::Producer producer(name, options);
  std::vector<double> values(options.dimensions);
  constexpr int kAppends = 4;
  for (int i = 0; i < kAppends; ++i) {
    for (double& value : values) value = script.byte();
    (void)producer.append({.time = script.near(producer.last_time()), .position = values});
    (void)producer.earliest();
  }
  (void)producer.replace_from(script.near(producer.last_time()), {});
  (void)producer.wait_for_room(core::Time(0));
  (void)producer.finish({.kind = core::ConditionKind::halt, .value = {}});
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
  attempt([&] { ipc::remove_stream(name); });
}

void try_all(const StreamImage& image) {
  try_reader(image);
  try_writers(image);
  try_roles(image);
}

}  // namespace splinecast::fuzz
