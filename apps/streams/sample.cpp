#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/samples.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/attach.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

struct SampleOptions {
  std::string stream;
  std::string at;
  std::optional<TimeUnit> time_unit;
  double rate = 0;
  std::size_t count = 0;
  std::string output;
  Time wait{10'000'000'000};
  Trust trust;
};

/// Samples one stream to a file. Attaches again if the stream is recreated.
class Sampling {
 public:
  Sampling(const SampleOptions& options, std::vector<Time> times)
      : options_(options),
        times_(std::move(times)),
        reader_(attach_reader(options.stream, options.wait, options.trust)),
        // With --rate others can follow the file while it grows.
        output_(options.output, options.at.empty() ? Writing::growing : Writing::whole),
        state_(reader_.dimensions()),
        none_(reader_.dimensions()),
        writer_(output_, reader_.dimensions(), reader_.kinds(), true) {
    fill_with_nan(none_);
  }

  int run() {
    const bool is_complete = write_all();
    output_.close();
    if (!is_complete) throw Interrupted("interrupted");
    return kOk;
  }

 private:
  /// Returns false if a stop is requested meanwhile, as the functions that it calls do.
  bool write_all() {
    if (!options_.at.empty()) {
      return std::ranges::all_of(times_, [this](Time t) { return write(t); });
    }
    return is_live(reader_.clock()) ? follow_live() : step_through_recording();
  }

  static void fill_with_nan(State& state) {
    const StateRef all = state.ref();
    for (const auto part : {all.position, all.velocity, all.acceleration, all.jerk}) {
      std::ranges::fill(part, std::numeric_limits<double>::quiet_NaN());
    }
  }

  [[nodiscard]] Time period_times(std::size_t k) const {
    return Time(std::llround(static_cast<double>(k) * 1e9 / options_.rate));
  }

  bool follow_live() {
    const Time start = clock_.now();
    for (std::size_t k = 0; k < options_.count; ++k) {
      const Time t = start + period_times(k);
      if (clock_.now() < t) output_.flush();  // others can read each line before the next one
      if (!sleep_until(t) || !write(t)) return false;
    }
    return true;
  }

  bool step_through_recording() {
    const Time start = first_knot();
    for (std::size_t k = 0; k < options_.count; ++k) {
      if (!write(start + period_times(k))) return false;
    }
    return true;
  }

  /// Time of the oldest knot that the board keeps.
  Time first_knot() {
    const Time end = deadline(clock_, options_.wait);
    for (;;) {
      if (const auto first = reader_.first_time()) return *first;
      if (stop_requested()) throw Interrupted("interrupted");
      if (clock_.now() >= end) {
        throw TimeOut(fmt::format("stream '{}' has no waypoints", options_.stream));
      }
      (void)reader_.wait(std::chrono::milliseconds(50));
    }
  }

  bool write(Time t) {
    if (stop_requested()) return false;
    const auto status = sample(t);
    if (!status) return false;
    writer_.write(t, has_values(*status) ? state_ : none_, to_string(*status));
    return true;
  }

  /// Samples at t. On a recorded stream, waits until the sample is final, or until nothing new has
  /// come for --wait. Returns nothing if a stop is requested meanwhile.
  std::optional<SampleStatus> sample(Time t) {
    Time end = deadline(clock_, options_.wait);
    for (;;) {
      const auto status = reader_.sample(t, state_);
      const bool has_answered = status != SampleStatus::retired && status != SampleStatus::busy;
      if (stop_requested() && !(has_answered && is_final(status))) return std::nullopt;
      if (status == SampleStatus::retired) {
        reattach();
        continue;
      }
      if (status == SampleStatus::busy && clock_.now() < end) {
        (void)reader_.wait(std::chrono::milliseconds(1));
        continue;
      }
      if (!patient_ || is_final(status)) return status;
      output_.flush();
      if (reader_.wait(std::chrono::milliseconds(20)) == WaitStatus::advanced) {
        end = deadline(clock_, options_.wait);
      } else if (clock_.now() >= end) {
        patient_ = false;
        say(fmt::format("stream '{}': nothing new for {} s; samples from {} ns on are not settled",
                        options_.stream, to_seconds(options_.wait), t.count()));
      }
    }
  }

  [[nodiscard]] bool is_final(SampleStatus status) const {
    if (is_live(reader_.clock())) return true;
    if (status == SampleStatus::settled || status == SampleStatus::before_history) {
      return true;
    }
    ipc::Summary summary;
    return ipc::Internals::summary(reader_, summary) && summary.finished;
  }

  void reattach() {
    const auto dimensions = ipc::dimensions_of(ipc::Internals::header(reader_));
    reader_ = attach_reader(options_.stream, options_.wait, options_.trust);
    if (reader_.dimensions() != dimensions.size()) {
      throw Failure(fmt::format("stream '{}' was recreated with {} dimensions, not {}",
                                options_.stream, reader_.dimensions(), dimensions.size()));
    }
    if (ipc::dimensions_of(ipc::Internals::header(reader_)) == dimensions) return;
    throw Failure(
        fmt::format("stream '{}' was recreated with other dimension kinds", options_.stream));
  }

  const SampleOptions& options_;
  std::vector<Time> times_;  ///< of --at
  MonotonicClock clock_;
  Reader reader_;
  Output output_;
  State state_;
  State none_;
  SampleWriter writer_;
  bool patient_ = true;  ///< whether to wait for samples that are not settled
};

/// The last sample's time must be in range.
void require_span(const SampleOptions& options) {
  if (options.count == 0) return;  // --at
  const double seconds = static_cast<double>(options.count - 1) / options.rate;
  const double most = to_seconds(kLongestTime);
  if (seconds <= most) return;
  throw UsageError("--count", fmt::format("{} samples at {} Hz take {} s; the maximum is {} s",
                                          options.count, options.rate, seconds, most));
}

int run_sample(const SampleOptions& options) {
  require_separate(std::array{options.output}, std::array{options.at});
  // Read the times before the output is opened: here a signal still ends the process at once.
  auto times = options.at.empty() ? std::vector<Time>{}
                                  : read_times(options.at, {.time_unit = options.time_unit});
  catch_stop_signals();
  return Sampling(options, std::move(times)).run();
}

void add_sample(Command& verb, Action& action) {
  auto options = std::make_shared<SampleOptions>();
  verb.option("STREAM", options->stream, "Name of the stream to read").required();
  const Argument at =
      verb.option("--at", options->at, "File with a time column: times at which to sample")
          .type("FILE");
  Argument rate = verb.option(
      "--rate",
      [options](const std::string& text) { options->rate = number_within("--rate", text); },
      "Sampling rate in Hz, 1e-6 to 1e9; needs --count");
  rate.type("HZ");
  Argument count =
      add_count(verb, "--count", options->count, "Number of samples, from 1; needs --rate");
  rate.needs(count).excludes(at);
  count.needs(rate);
  verb.option("-o,--output", options->output, "Output file (default: standard output)").type("OUT");
  add_seconds(
      verb, "--wait", options->wait,
      "Time in s to wait for the stream and, on a recorded stream, for new settled samples, "
      "from 0 (default 10)");
  add_time_unit(verb, options->time_unit);
  add_trust(verb, options->trust);
  verb.callback([&action, options, at, rate] {
    if (!at.is_given() && !rate.is_given()) {
      throw UsageError("sample", "needs --at, or --rate with --count");
    }
    require_span(*options);
    action = [options] { return run_sample(*options); };
  });
}

const Verb sample_verb("sample", 40, "Sample the curve of a stream and write CSV", add_sample);

}  // namespace

}  // namespace splinecast::apps
