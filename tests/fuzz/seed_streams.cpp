#include "tests/fuzz/seed_streams.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "ipc/law/commander_record.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/owned/request.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::fuzz {
namespace {

using ipc::RegionKind;
using ipc::Word;

constexpr Time kTick{10'000'000};
constexpr Word kStream = 7;  ///< stream id of each region
constexpr Time kBegin{1'000'000'000};

/// The words of a region in shared memory, made independent of the time and the machine: stream id,
/// owner and time namespace have fixed values, and the control block is at the offset of that id.
std::vector<Word> words_of(const std::string& stream, RegionKind kind) {
  const auto region = ipc::Region::open(stream, kind, false);
  const auto from = ipc::words_at(region.bytes(), 0, region.bytes().size() / sizeof(Word));
  std::vector<Word> words(from.begin(), from.end());
  constexpr std::size_t kControl = ipc::kHeaderBytes + kStream * ipc::kSeparation;
  constexpr std::size_t kControlOffset = ipc::word_of(ipc::kHeaderFields, "control offset");
  const auto area = std::span(words)
                        .first(ipc::kBodyOffset / sizeof(Word))
                        .subspan(ipc::kHeaderBytes / sizeof(Word));
  const std::size_t control_words =
      kind == RegionKind::commander ? ipc::kCommanderControlWords : ipc::kBoardControlWords;
  const auto block = std::span(words).subspan(words[kControlOffset] / sizeof(Word), control_words);
  const std::vector<Word> control(block.begin(), block.end());
  std::ranges::fill(area, 0);
  std::ranges::copy(control, words.begin() + kControl / sizeof(Word));
  words[kControlOffset] = kControl;
  words[ipc::word_of(ipc::kHeaderFields, "stream id")] = kStream;
  words[ipc::word_of(ipc::kHeaderFields, "process id")] = 1;
  words[ipc::word_of(ipc::kHeaderFields, "since")] = 0;
  const bool is_live = words[ipc::word_of(ipc::kHeaderFields, "clock")] != 0;
  words[ipc::word_of(ipc::kHeaderFields, "time namespace")] = is_live ? kHere : 0;
  return words;
}

/// A time law between a commander's region and a real solver, in simulated time: its rate rises,
/// and it is held. The rows of its commander have the id of an image.
StreamImage law_image(std::vector<std::uint8_t> script) {
  const std::string name = "test." + std::to_string(getpid()) + ".seed";
  const std::string commander = ipc::commander_stream(name, "c");
  StreamImage image;
  {
    ipc::OwnerLock lock(commander, RegionKind::commander);
    ipc::OwnedRequest own = ipc::own_request(commander, ipc::RegionKind::commander, {}, {}, lock);
    testing::FixedClock clock;
    clock.time = kBegin;
    Solver solver(name, SolverOptions{});
    ipc::RateCommand command;
    for (const double rate : {0.25, 0.75, 0.0}) {
      ++command.number;
      command.time = clock.time;
      command.rate = rate;
      command.ramp = 5 * kTick;
      ipc::write_command(own.control, command);
      for (int i = 0; i < 4 && solver.attach(clock); ++i) {
        clock.time += kTick;
        (void)solver.step(clock);
      }
    }
    image = {.ring = words_of(name, RegionKind::waypoints),
             .board = words_of(name, RegionKind::spline),
             .commander = words_of(commander, RegionKind::commander),
             .script = std::move(script)};
    std::ranges::replace(image.board, own.id, kStream);
  }
  remove_stream(name);
  return image;
}

/// A stream between a real producer and a real solver, in simulated time.
class Recorder {
 public:
  Recorder(ProducerOptions options, const SolverOptions& how)
      : name_("test." + std::to_string(getpid()) + ".seed"),
        dimensions_(options.dimensions),
        producer_(name_, std::move(options)),
        solver_(name_, how) {
    clock.time = kBegin;
    if (!solver_.attach()) throw std::logic_error("the solver does not find the stream");
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void step() { (void)solver_.step(clock); }
  void send(Time t, double scale = 1) {
    const auto values = motion(t, scale);
    const std::span<const double> all(values);
    (void)producer_.append({.time = t,
                            .position = all.first(dimensions_),
                            .velocity = all.subspan(dimensions_, dimensions_),
                            .acceleration = all.last(dimensions_)});
    step();
  }
  void send_many(Time first, int count, Time interval = kTick) {
    for (int i = 0; i < count; ++i) send(first + i * interval);
  }
  void start_from(Time t) {
    const auto values = motion(t, 1);
    const std::span<const double> all(values);
    (void)producer_.start_from({.time = t,
                                .position = all.first(dimensions_),
                                .velocity = all.subspan(dimensions_, dimensions_),
                                .acceleration = all.last(dimensions_)});
    step();
  }
  void replace_from(Time t, Time next) {
    const auto values = motion(next, 2);
    const Waypoint waypoint{.time = next, .position = std::span(values).first(dimensions_)};
    (void)producer_.replace_from(t, std::span(&waypoint, next > t ? 1 : 0));
    step();
  }
  void finish(ConditionKind end = ConditionKind::halt) {
    (void)producer_.finish({.kind = end, .value = {}});
    step();
  }

  [[nodiscard]] StreamImage image(std::vector<std::uint8_t> script) const {
    return {.ring = words_of(name_, RegionKind::waypoints),
            .board = words_of(name_, RegionKind::spline),
            .commander = {},
            .script = std::move(script)};
  }
  [[nodiscard]] const std::string& name() const { return name_; }

  testing::FixedClock clock;

 private:
  [[nodiscard]] std::vector<double> motion(Time t, double scale) const {
    const double s = to_seconds(t - kBegin);
    std::vector<double> values;
    for (const int derivative : {0, 1, 2}) {
      for (std::size_t d = 0; d < dimensions_; ++d) {
        const double w = 1.0 + static_cast<double>(d);
        const double phase = w * s + derivative * std::acos(-1.0) / 2;
        values.push_back(scale * std::pow(w, derivative) * std::sin(phase));
      }
    }
    return values;
  }

  std::string name_;
  std::size_t dimensions_;
  Producer producer_;
  Solver solver_;
};

ProducerOptions recorded(std::size_t dimensions) {
  return {.dimensions = dimensions,
          .names = {},
          .units = {},
          .kinds = {},
          .clock = StreamClock::recorded,
          .start = {},
          .limits = {},
          .capacity = 8};
}

ProducerOptions live(std::size_t dimensions) {
  auto options = recorded(dimensions);
  options.clock = StreamClock::monotonic;
  options.horizon = Time::max();
  options.start = {.kind = ConditionKind::halt, .value = {}};
  return options;
}

SolverOptions with(const char* method, std::size_t settle, std::size_t capacity) {
  SolverOptions how;
  how.method = find_method(method);
  how.settle = settle;
  how.capacity = capacity;
  return how;
}

struct Plan {
  const char* name;
  ProducerOptions options;
  SolverOptions how;
  std::function<void(Recorder&)> play;
};

SolverOptions limited() {
  auto how = with("c2", 2, 32);
  how.limits = {.acceleration = {5.0, 0.0}};
  return how;
}

/// Limits so large that two waypoints are joined from rest to rest, without an entry.
SolverOptions wide() {
  auto how = with("c2", 2, 32);
  how.limits = {.acceleration = {1e6, 1e6}};
  return how;
}

SolverOptions smoothing() {
  auto how = with("smoothing", 16, 64);
  how.lambda = 1e-9;
  return how;
}

/// A periodic dimension and a quaternion.
ProducerOptions kinds() {
  auto options = recorded(5);
  options.kinds.assign(5, {.kind = DimensionKind::quaternion});
  options.kinds[0] = {.kind = DimensionKind::periodic, .period = 1.5};
  options.names = {"heading", "qx", "qy", "qz", "qw"};
  options.units = {"rad", "", "", "", ""};
  return options;
}

ProducerOptions moving() {
  auto options = recorded(1);
  options.start = {.kind = ConditionKind::velocity, .value = {2.0}};
  return options;
}

void finish_after_a_refusal(Recorder& r) {
  r.send_many(kBegin, 12);
  r.send(kBegin);  // refused: out of order
  r.finish();
}

void send_two_and_finish(Recorder& r) {
  r.send_many(kBegin + 2 * kTick, 2);
  r.finish();
}

void starve(Recorder& r) {
  r.send_many(kBegin + 2 * kTick, 4);
  r.clock.time += 200 * kTick;
  r.step();
}

void enter(Recorder& r) {
  starve(r);
  r.send_many(r.clock.time + 2 * kTick, 3);
}

void replace(Recorder& r) {
  r.start_from(kBegin + kTick);
  r.send_many(kBegin + 3 * kTick, 6);
  r.replace_from(kBegin + 6 * kTick, kBegin + 9 * kTick);
  r.replace_from(kBegin + 8 * kTick, kBegin);
}

void cut(Recorder& r) {
  r.send_many(kBegin + 2 * kTick, 8);
  r.replace_from(kBegin + 8 * kTick + kTick / 2, kBegin + 10 * kTick);  // within a segment
  r.replace_from(kBegin + 9 * kTick, kBegin);                           // within an entry
  r.replace_from(kBegin + 10 * kTick, kBegin + 12 * kTick);             // within the stop
  r.send_many(kBegin + 13 * kTick, 3);
  r.finish();
}

void starve_and_cut(Recorder& r) {
  starve(r);
  r.send_many(r.clock.time + 2 * kTick, 6);
  r.replace_from(r.clock.time + 4 * kTick + kTick / 4, r.clock.time + 6 * kTick);
}

void starve_and_finish(Recorder& r) {
  starve(r);
  r.finish();
}

void slow_down(Recorder& r) {
  r.start_from(kBegin + kTick);
  r.send_many(kBegin + 4 * kTick, 44);
  r.finish();
  for (int i = 0; i < 200; ++i) r.step();  // a search continues in the next step
}

std::vector<Plan> plans() {
  return {
      {"c2_running", recorded(1), with("c2", 2, 32), [](Recorder& r) { r.send_many(kBegin, 40); }},
      {"c2_finished", moving(), with("c2", 8, 32), finish_after_a_refusal},
      {"two_waypoints", live(2), wide(), send_two_and_finish},
      {"live_running", live(2), limited(),
       [](Recorder& r) { r.send_many(kBegin + 2 * kTick, 10); }},
      {"live_starved", live(1), with("c2", 2, 32), starve},
      {"live_entered", live(1), with("makima", 2, 32), enter},
      {"live_replaced", live(2), limited(), replace},
      {"live_cut", live(2), with("c2", 3, 32), cut},
      {"smoothing_cut", live(1), smoothing(), starve_and_cut},
      {"live_way_back", live(1), with("pchip", 1, 16), starve_and_finish},
      {"live_slowed", live(2), with("c2", 8, 64), slow_down},
      {"quintic", recorded(1), with("quintic", 1, 16), [](Recorder& r) { r.send_many(kBegin, 5); }},
      {"smoothing", recorded(1), smoothing(), [](Recorder& r) { r.send_many(kBegin, 24); }},
      {"kinds", kinds(), with("rounded", 1, 16), [](Recorder& r) { r.send_many(kBegin, 6); }},
      {"empty", live(3), with("hermite", 1, 16), [](Recorder& r) { r.step(); }},
  };
}

/// A script of random actions, which mutations change.
std::vector<std::uint8_t> script_of(std::size_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> script(160);
  for (auto& byte : script) byte = static_cast<std::uint8_t>(random());
  return script;
}

}  // namespace

std::vector<Seed> make_seeds() {
  std::vector<Seed> seeds;
  for (Plan& plan : plans()) {
    std::string name;
    {
      Recorder recorder(plan.options, plan.how);
      plan.play(recorder);
      name = recorder.name();
      seeds.push_back({.name = plan.name, .image = recorder.image(script_of(seeds.size()))});
    }
    remove_stream(name);
  }
  seeds.push_back({.name = "law", .image = law_image(script_of(seeds.size()))});
  return seeds;
}

}  // namespace splinecast::fuzz
