#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"

/// `bits write STREAM` solves a fixed recording into a stream, `bits read STREAM` prints a hash of
/// all samples that it takes from it, `bits remove STREAM` removes it. The hash must not depend on
/// how writer and reader were compiled.
namespace {

using splinecast::AppendStatus;
using splinecast::MonotonicClock;
using splinecast::Producer;
using splinecast::Reader;
using splinecast::remove_stream;
using splinecast::SampleStatus;
using splinecast::Solver;
using splinecast::StreamClock;
using splinecast::Time;

constexpr std::size_t kDimensions = 5;
constexpr int kWaypoints = 2000;

/// A generator of the same numbers on every machine.
class Random {
 public:
  std::uint64_t next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return state_ >> 16U;
  }
  double unit() { return static_cast<double>(next() % 2'000'001) / 1e6 - 1; }

 private:
  std::uint64_t state_ = 42;
};

void write(const std::string& stream) {
  using splinecast::DimensionKind;
  std::vector<splinecast::Dimension> kinds(kDimensions, {.kind = DimensionKind::quaternion});
  kinds[0] = {.kind = DimensionKind::periodic, .period = 0.3};
  Producer producer(stream, {.dimensions = kDimensions,
                             .kinds = kinds,
                             .clock = StreamClock::recorded,
                             .start = {splinecast::ConditionKind::halt, {}}});
  Solver solver(stream, {});
  solver.attach();
  const MonotonicClock clock;
  Random random;
  std::vector<double> x(kDimensions);
  Time t{1'403'636'579'763'555'584};
  for (int i = 0; i < kWaypoints; ++i) {
    for (double& value : x) value += 0.1 * random.unit();
    t += Time(1'000'000 + random.next() % 9'000'000);
    while (producer.append({t, x, {}, {}}) == AppendStatus::full) solver.step(clock);
  }
  while (producer.finish({splinecast::ConditionKind::halt, {}}) == AppendStatus::full) {
    solver.step(clock);
  }
  while (solver.step(clock).consumed > 0) {
  }
}

void read(const std::string& stream) {
  Reader reader(stream);
  splinecast::State state(kDimensions);
  const auto oldest = reader.first_time();
  const auto progress = reader.progress();
  if (!oldest || !progress) std::abort();
  const Time first = *oldest;
  const auto length = static_cast<std::uint64_t>((progress->newest - first).count());
  Random random;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (int i = 0; i < 100'000; ++i) {
    const Time t = first + Time(static_cast<std::int64_t>(random.next() % length));
    if (reader.sample(t, state) != SampleStatus::settled) std::abort();
    for (const double value : state.values()) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x100000001b3;
    }
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(hash));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string verb = argv[1];
  if (verb == "write") write(argv[2]);
  if (verb == "read") read(argv[2]);
  if (verb == "remove") remove_stream(argv[2]);
  return 0;
}
